-- `mocc lsp` with headless Neovim, 0.7 or later:
--   MOCC=target/release/mocc nvim --headless -u NONE -i NONE -n -c 'luafile tests/editor/nvim.lua'
local function fail(why)
  io.stderr:write("nvim: " .. why .. "\n")
  vim.cmd("cquit 1")
end

local function check()
  local root = vim.fn.getcwd()
  local text = table.concat(vim.fn.readfile(root .. "/examples/oscillator.mol"), "\n")
  vim.cmd("edit " .. vim.fn.tempname() .. ".mol")
  vim.api.nvim_buf_set_lines(0, 0, -1, false, vim.split(text, "\n"))
  local buffer = vim.api.nvim_get_current_buf()
  local id = vim.lsp.start_client({ cmd = { vim.env.MOCC or "mocc", "lsp" }, name = "mocc", root_dir = root })
  assert(id, "the server does not start")
  vim.lsp.buf_attach_client(buffer, id)
  local client
  assert(vim.wait(5000, function()
    client = vim.lsp.get_client_by_id(id)
    return client ~= nil and client.initialized
  end), "the server does not answer")
  local document = { uri = vim.uri_from_bufnr(buffer) }
  local function ask(method, parameters)
    local answer = client.request_sync(method, parameters, 5000, buffer)
    assert(answer and answer.result, method .. " has no answer")
    return answer.result
  end
  assert(#ask("textDocument/codeLens", { textDocument = document }) == 3, "three lenses")
  assert(#ask("textDocument/documentSymbol", { textDocument = document }) == 1, "one model in the outline")
  local whole = { start = { line = 0, character = 0 }, ["end"] = { line = 99, character = 0 } }
  assert(#ask("textDocument/inlayHint", { textDocument = document, range = whole }) > 0, "hints")
  -- A mistake shows up while typing.
  local last = vim.api.nvim_buf_line_count(buffer)
  for k = 0, last - 1 do
    local line = vim.api.nvim_buf_get_lines(buffer, k, k + 1, false)[1]
    if line:find("connect") then
      vim.api.nvim_buf_set_lines(buffer, k, k + 1, false, { (line:gsub("wall", "wal")) })
      break
    end
  end
  assert(vim.wait(5000, function() return #vim.diagnostic.get(buffer) > 0 end), "no diagnostic")
  local found = vim.diagnostic.get(buffer)[1]
  assert(found.message:find("wal"), found.message)
  vim.lsp.stop_client(id)
end

local ok, why = pcall(check)
if not ok then fail(tostring(why)) end
vim.cmd("qall!")
