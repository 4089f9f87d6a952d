-- What Neovim's own client gets of `scenic-ref lsp`: run by test_neovim.py, which gives the command in SERVER and the file in FILE.
local function say(name, value)
  io.stdout:write(name .. "\t" .. vim.fn.json_encode(value) .. "\n")
end

local function wait(condition)
  assert(vim.wait(300000, condition, 50), "nothing came")
end

local file = os.getenv("FILE")
vim.cmd("edit " .. file)
local id = vim.lsp.start_client({ name = "scenic", cmd = vim.fn.json_decode(os.getenv("SERVER")), root_dir = vim.fn.fnamemodify(file, ":h") })
local buffer = vim.api.nvim_get_current_buf()
assert(vim.lsp.buf_attach_client(buffer, id))

wait(function() return #vim.diagnostic.get(buffer) > 0 end)
local problem = vim.diagnostic.get(buffer)[1]
say("diagnostic", { problem.lnum, problem.col, problem.end_col, problem.message, problem.severity })

local function ask(method, line, column)
  local position = { line = line, character = column }
  local params = { textDocument = vim.lsp.util.make_text_document_params(buffer), position = position }
  local answers = assert(vim.lsp.buf_request_sync(buffer, method, params, 300000))
  return answers[id].result
end

say("hover", ask("textDocument/hover", 2, 11).contents.value)
say("definition", ask("textDocument/definition", 2, 7))
local labels = {}
for _, item in ipairs(ask("textDocument/completion", 2, 10).items) do table.insert(labels, item.label) end
say("completion", labels)

vim.api.nvim_buf_set_lines(buffer, 3, 4, false, { "y = 1" })
wait(function() return #vim.diagnostic.get(buffer) == 0 end)
say("mended", #vim.diagnostic.get(buffer))
vim.api.nvim_win_set_cursor(0, { 3, 6 })
vim.lsp.buf.definition()
wait(function() return vim.fn.expand("%:t") == "cars.scenic" end)
say("jumped", { vim.fn.expand("%:t"), vim.api.nvim_win_get_cursor(0) })
vim.lsp.stop_client(id)
wait(function() return vim.lsp.client_is_stopped(id) end)
vim.cmd("qall!")
