-- @put heading
--
-- Copy it to APM/scripts on the card. It reads the motor outputs and reports how close the vehicle is to losing control:
-- FR_RISK and FR_ELEV in %, and a text when the level changes. It changes nothing on the vehicle. Installation, cost and
-- tests: docs/firmware.md of FLAGRED.
--
-- An error while ArduPilot loads a script blocks arming. Therefore ArduPilot compiles only this loader; the rest of the file is
-- a comment. The loader reads the file again and compiles it part by part, which takes less memory than all at once. If that
-- fails, it sends a text and ends. Each part ends at a form feed. The parts share this table as their environment.

local shared = {
  floor = math.floor, sqrt = math.sqrt, exp = math.exp, abs = math.abs, huge = math.huge, min = math.min, max = math.max,
  format = string.format, sub = string.sub, match = string.match, gmatch = string.gmatch, rep = string.rep,
  unpack = table.unpack, ipairs = ipairs, error = error, pcall = pcall, tonumber = tonumber, tostring = tostring,
  gcs = gcs, param = param, micros = micros, vehicle = vehicle, logger = logger, SRV_Channels = SRV_Channels,
-- @if battery
  battery = battery,
-- @end
}
-- @put parts
local number, chunk = 1, nil -- the number of the next part, and the part once it is compiled
local file, is_over = nil, false -- the file of this script, and whether the part that is being read has ended

local function open()
  if not load then
    error("needs ArduPilot 4.4 or newer", 0)
  end
  local _, place = pcall(function()
    error("")
  end)
  local path = string.match(place, "^(.*):%d+:")
  file = path and io.open(path, "r")
  if not file then
    error("cannot read its own file", 0)
  end
end

-- The next line of a part, without the mark that makes it a comment; nil at the end of the part.
local function line()
  if is_over then
    return nil
  end
  local found = file:read("L")
  if not found or string.sub(found, -1) ~= "\n" then
    error("its file is cut off", 0)
  end
  is_over = string.sub(found, 4, 4) == "\f"
  return not is_over and string.sub(found, 4) or nil
end

-- Compiles the next part, or runs the part that was compiled. Returns whether there is more to do.
local function go_on()
  if chunk then
    local part = chunk
    chunk, number = nil, number + 1
    part()
    return number <= #PARTS
  end
  is_over = false
  if not file then
    open()
    while line() do
    end
    return true
  end
  local why
  chunk, why = load(line, "=" .. PARTS[number], "t", shared)
  if not chunk then
    error(why, 0)
  end
  return true
end

local function load_all()
  local is_well, continues = pcall(go_on)
  if is_well and continues then
    return load_all, 10
  end
  if file then
    file:close()
  end
  if is_well then
    return shared.begin, 30
  end
  local why = string.find(continues, "not enough mem", 1, true) and "increase SCR_HEAP_SIZE" or continues
  gcs:send_text(3, string.sub("FLAGRED is off: " .. why, 1, 50))
end

return load_all, 1000
