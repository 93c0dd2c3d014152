-- Run by neovim.sh: fails if the server does not behave as documented in docs/editors.md.
local function fail(why)
  io.stderr:write(why .. "\n")
  vim.cmd("cquit 1")
end

local function must(holds, why)
  if not holds then fail(why) end
end

local ran, why = pcall(function()
  local id = vim.lsp.start_client({ name = "flagred", cmd = { "flagred", "lsp" }, root_dir = vim.fn.getcwd() })
  must(id, "the server did not start")
  vim.lsp.buf_attach_client(0, id)
  must(vim.wait(10000, function() return #vim.diagnostic.get(0) > 0 end, 20), "no diagnostics")
  local found = vim.diagnostic.get(0)[1]
  must(found.lnum == 7 and found.message:find("did you mean `slow`"), "diagnostic: " .. vim.inspect(found))

  local function ask(method, line, column, more)
    local asked = { textDocument = vim.lsp.util.make_text_document_params(), position = { line = line, character = column } }
    for key, value in pairs(more or {}) do asked[key] = value end
    local answers = vim.lsp.buf_request_sync(0, method, asked, 10000)
    must(answers and answers[id], method .. ": no answer")
    must(not answers[id].err, method .. ": " .. vim.inspect(answers[id].err))
    return answers[id].result
  end

  -- Correct the mistake like a user: the diagnostic disappears.
  local line = vim.api.nvim_buf_get_lines(0, 7, 8, false)[1]
  vim.api.nvim_buf_set_lines(0, 7, 8, false, { (line:gsub("slwo", "slow")) })
  local function errors() return vim.diagnostic.get(0, { severity = vim.diagnostic.severity.ERROR }) end
  must(vim.wait(10000, function() return #errors() == 0 end, 20), "the diagnostic stays")

  local labels = {}
  for _, item in ipairs(ask("textDocument/completion", 8, 15)) do labels[item.label] = true end
  must(labels.low and labels.high, "completion: " .. vim.inspect(labels))
  must(ask("textDocument/hover", 7, 34).contents.value:find("slow"), "hover")
  must(ask("textDocument/definition", 7, 34).range.start.line == 5, "definition")

  local edit = ask("textDocument/rename", 7, 16, { newName = "cold" })
  vim.lsp.util.apply_workspace_edit(edit, "utf-16")
  local text = table.concat(vim.api.nvim_buf_get_lines(0, 0, -1, false), "\n")
  must(text:find("%[cold, high%]") and text:find("IF heat IS cold"), "rename: " .. text)
end)
must(ran, tostring(why))
vim.cmd("qall!")
