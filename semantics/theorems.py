"""Which rules the machine-checked theorems of `proofs/` (of the project's repository) are about.

Most names of theorems are sentences; the theories mirror the files of this package. `proofs/README.md` says from which assumptions they are proved.
"""

from __future__ import annotations

from collections.abc import Mapping

MACHINE = "kernel/Machine.v"
RESOLUTION, OPERATORS, SOFT = "scenes/Resolution.v", "scenes/Operators.v", "scenes/SoftRequirements.v"
POLICY, REJECTION, PROGRAMS = "dynamics/Policy.v", "inference/Rejection.v", "inference/Programs.v"

SUCCEEDS = "resolution_succeeds_exactly_when_no_property_is_specified_twice_and_dependencies_are_present_and_acyclic"
FIRST_ERROR = "the_error_is_that_of_the_first_phase_that_finds_one"
TWICE = "the_property_specified_twice_is_the_first_that_is_and_its_specifiers_are_named_in_the_order_of_the_source"
TWICE_OPTIONALLY = "the_property_specified_twice_optionally_is_the_first_that_is_and_all_its_specifiers_are_named"
MISSING = "the_missing_property_is_one_that_nothing_determines_and_what_depends_on_it_is_named"
WAITING = "what_waits_depends_on_what_waits_and_nothing_else_hangs_on_a_cycle"
OFFSETS = ("an_offset_is_as_far_as_it_says", "an_offset_can_be_read_back", "offsets_along_one_heading_add_up")
LOCAL = (*OFFSETS, "a_local_offset_is_one_along_the_heading")
OBJECT = ("the_object_has_the_properties_that_are_specified_or_have_a_default", "each_value_is_computed_from_the_values_that_the_finished_object_has")
TERMINATED = "no_action_is_returned_in_a_time_step_in_which_the_scenario_ends"
ALWAYS = "a_terminated_simulation_has_satisfied_every_require_always_at_every_time_step"
EVENTUALLY = (
    "a_terminated_simulation_has_satisfied_every_require_eventually_at_some_time_step",
    "a_simulation_that_terminates_has_satisfied_every_require_eventually_since_it_began",
)
ORDERED = (
    "the_verdict_is_that_of_the_first_step_that_decides",
    "a_simulation_is_discarded_in_the_first_step_that_fails_if_none_before_ends_it",
)
FAILED = "a_requirement_that_fails_in_the_first_three_steps_discards_the_simulation_though_the_flag_is_set"
STEP_4 = "a_simulation_terminates_in_step_4_whatever_the_behaviors_do"
STEP_6 = "a_simulation_terminates_in_step_6_exactly_if_a_behavior_ends_it_where_nothing_failed_or_ended_it_before"
ACTS = "actions_are_returned_exactly_if_nothing_fails_and_nothing_ends_the_simulation"
DETERMINED = ("the_function_says_what_the_rules_say", "two_steps_with_one_answer_lead_to_one_configuration")
CORE = (
    "E-Constant E-Variable E-Attribute E-Arithmetic E-Not E-Compare E-Boolean O-VectorOf P-With P-At S-Assignment S-Param S-Require-Capture S-Mutate "
    "T-Mutate"
)
"""Rules of which the theories have no theorem beside those of all rules of the machine. The theory's noise in T-Mutate is finite."""
SAMPLED = ("rejection_sampling_of_a_program_has_its_law", "all_attempts_at_a_program_fail_with_a_power_of_its_rejection")
MIXED = "a_soft_requirement_mixes_the_runs_with_and_without_it"
BESIDE = "an_object_beside_another_is_as_far_from_it_as_it_says"
GAPS = {
    "LeftOf": "an_object_to_the_left_leaves_the_gap_at_its_right", "RightOf": "an_object_to_the_right_leaves_the_gap_at_its_left",
    "AheadOf": "an_object_ahead_leaves_the_gap_behind_it", "Behind": "an_object_behind_leaves_the_gap_ahead_of_it",
}  # fmt: skip
"""By the first words of the rules: what lies between an object and what it is beside."""
SIZES = "sides_are_half_the_size_away_and_corners_half_the_diagonal"
SIDES = "Front Back Left Right FrontLeft BackLeft FrontRight BackRight"
PLUS = "a_relative_position_is_what_leads_there"

THEOREMS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "R-ResolveSpecifiers": {MACHINE: DETERMINED, RESOLUTION: (
        SUCCEEDS, "the_order_returned_is_admissible", *OBJECT,
        "each_property_is_determined_by_its_non_optional_specifier_else_its_optional_one_else_its_default",
        "each_property_is_determined_exactly_once", "every_dependency_is_determined_before_its_dependents",
        "any_two_topological_orders_build_the_same_object",
        "the_order_of_specifiers_in_the_source_is_irrelevant",
    )},
    "R-SpecifiedTwice": {RESOLUTION: (SUCCEEDS, FIRST_ERROR, TWICE)},
    "R-SpecifiedTwiceOptionally": {RESOLUTION: (SUCCEEDS, FIRST_ERROR, TWICE_OPTIONALLY)},
    "R-MissingProperty": {RESOLUTION: (SUCCEEDS, FIRST_ERROR, MISSING)},
    "R-Cyclic": {
        RESOLUTION: (SUCCEEDS, FIRST_ERROR, WAITING, "the_graph_of_properties_is_acyclic_exactly_when_that_of_specifiers_is"),
        "scenes/Ordering.v": (
            "no_order_is_found_only_if_there_is_a_cycle", "what_has_a_topological_order_has_no_cycle",
            "what_is_left_depends_on_what_is_left_and_nothing_else_hangs_on_a_cycle",
        ),
    },
    "E-ObjectDefinition": {MACHINE: DETERMINED, RESOLUTION: OBJECT},
    "P-Default": {MACHINE: DETERMINED, RESOLUTION: ("the_default_is_that_of_the_most_derived_class",)},
    "S-SoftReq-Check": {MACHINE: DETERMINED, SOFT: (
        "demanded_with_probability_1_is_hard", "probability_under_run_is_q_over_1_minus_p_plus_p_q",
        "probability_under_run_is_below_p_iff_q_is_below_p_over_1_plus_p",
        "probability_under_scene_is_p_plus_1_minus_p_times_q", "the_claim_is_false_under_run",
        "the_claim_is_true_under_scene_of_what_is_possible", "accepted_mass_of_an_outcome_is_prior_times_survival",
    ), PROGRAMS: (
        MIXED, "a_soft_requirement_of_a_program_holds_with_q_over_1_minus_p_plus_p_q", "the_claim_of_section_5_1_fails_for_this_program",
    )},
    "S-SoftReq-Skip": {
        MACHINE: DETERMINED,
        SOFT: ("demanded_with_probability_0_is_no_requirement", "accepted_mass_of_an_outcome_is_prior_times_survival"),
        PROGRAMS: (MIXED,),
    },
    **{rule: {MACHINE: DETERMINED} for rule in CORE.split()},
    "E-Distributions": {MACHINE: (*DETERMINED, "the_distribution_at_a_draw_is_a_mixture", "the_masses_of_all_runs_add_up_to_1")},
    "S-Require": {
        MACHINE: (*DETERMINED, "a_stuck_run_contributes_nothing"),
        REJECTION: ("a_scene_found_within_n_attempts_has_the_desired_distribution",), PROGRAMS: SAMPLED,
    },
    "T-Check": {
        MACHINE: (*DETERMINED, "a_stuck_run_contributes_nothing", "the_law_of_scenes_is_that_of_done_runs_divided_by_their_mass"),
        REJECTION: ("a_scene_found_within_n_attempts_has_the_desired_distribution",), PROGRAMS: SAMPLED,
    },
    "D-Policy-1": {POLICY: (*ORDERED, FAILED, TERMINATED)},
    "D-Policy-2": {POLICY: (*ORDERED, FAILED, ALWAYS)},
    "D-Policy-3": {POLICY: (*ORDERED, FAILED, TERMINATED)},
    "D-Policy-4": {POLICY: (*ORDERED, STEP_4, TERMINATED, *EVENTUALLY)},
    "D-Policy-5": {POLICY: (*ORDERED, TERMINATED, "a_behavior_that_fails_discards_the_simulation_though_another_terminates_the_scenario")},
    "D-Policy-6": {POLICY: (*ORDERED, STEP_6, TERMINATED, *EVENTUALLY)},
    "D-Policy-7": {POLICY: (
        ORDERED[0], ACTS, TERMINATED, "no_action_is_returned_in_a_time_step_in_which_a_requirement_failed",
    )},
    "D-Always": {POLICY: (ALWAYS,)},
    "D-Eventually": {POLICY: (*EVENTUALLY, "a_simulation_that_is_thrown_away_failed_a_requirement")},
    **{rule: {POLICY: (ORDERED[0], STEP_4, STEP_6, ACTS)} for rule in ("D-Terminate", "D-TerminateWhen")},
    **{rule: {OPERATORS: OFFSETS} for place in ("O", "P") for rule in (f"{place}-OffsetAlong-Heading", f"{place}-OffsetAlong-Field")},
    **{rule: {OPERATORS: (PLUS,)} for rule in ("O-OffsetBy-Vector", "O-RelativeTo-Vectors", "P-OffsetBy-Global", "O-RelativePosition")},
    **{f"O-{side}Of": {OPERATORS: (SIZES, *LOCAL)} for side in SIDES.split()},
    **{rule: {OPERATORS: LOCAL} for rule in ("O-OffsetBy-OrientedPoint", "P-OffsetBy-Local", "O-RelativeTo-VectorOrientedPoint")},
    "P-Beyond": {OPERATORS: (
        "what_lies_beyond_is_as_far_from_the_point_as_it_says", "straight_beyond_is_on_the_line_of_sight_and_so_much_further",
        "the_offset_beyond_can_be_read_back",
    )},
    "P-ApparentlyFacing": {OPERATORS: ("an_object_apparently_faces_what_it_was_told",)},
    **{f"O-ApparentHeading{up_to}": {OPERATORS: ("an_object_apparently_faces_what_it_was_told",)} for up_to in ("", "-Wrapped")},
    **{f"O-RelativeHeading{up_to}": {OPERATORS: ("a_relative_heading_is_what_was_added",)} for up_to in ("", "-Wrapped")},
    "O-RelativeTo-Headings": {OPERATORS: ("a_relative_heading_is_what_was_added", "headings_are_a_commutative_group")},
    "O-DistancePast": {OPERATORS: ("the_distance_past_is_the_forward_part_of_the_offset",)},
    "O-Angle": {OPERATORS: ("the_heading_of_a_vector_turns_north_into_it", "no_other_heading_does")},
    "O-Distance": {OPERATORS: (
        "distances_are_the_same_both_ways_and_0_only_from_a_point_to_itself", "the_way_round_is_not_shorter", "rotation_preserves_distances",
    )},
    "P-FacingToward": {OPERATORS: ("what_faces_toward_a_point_has_it_straight_ahead",)},
    "P-FacingAwayFrom": {OPERATORS: ("what_faces_away_from_a_point_has_it_straight_behind",)},
    **{f"P-{side}-{of}": {OPERATORS: (gap,)} for side, gap in GAPS.items() for of in ("OrientedPoint", "Vector")},
    **{f"P-{side}-Object": {OPERATORS: (gap, BESIDE)} for side, gap in GAPS.items()},
}  # fmt: skip
"""By the rule's id and the theory: the theorems."""


def theorems_of(rule: str) -> list[str]:
    """The theorems about a rule, each with its theory."""
    return [f"{theory}: {name}" for theory, names in THEOREMS.get(rule, {}).items() for name in names]
