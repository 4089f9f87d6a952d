"""From text to syntax trees and back: the grammar, the parser, the printer, dialects, static checks and warnings."""
