-- What Neovim's own client gets of `scenic-ref lsp`: run by test_neovim.py behind the lines of docs/editors.md, for the file in FILE.
local function say(name, value)
  io.stdout:write(name .. "\t" .. vim.fn.json_encode(value) .. "\n")
end

local function wait(condition)
  assert(vim.wait(300000, condition, 50), "nothing came")
end

vim.cmd("edit " .. os.getenv("FILE"))
local buffer = vim.api.nvim_get_current_buf()
wait(function() return #vim.diagnostic.get(buffer) > 0 end)
local id = vim.lsp.get_active_clients()[1].id
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
vim.api.nvim_feedkeys("gd", "mx", false)
wait(function() return vim.fn.expand("%:t") == "cars.scenic" end)
say("jumped", { vim.fn.expand("%:t"), vim.api.nvim_win_get_cursor(0) })
vim.lsp.stop_client(vim.lsp.get_active_clients())
wait(function() return #vim.lsp.get_active_clients() == 0 end)
vim.cmd("qall!")
