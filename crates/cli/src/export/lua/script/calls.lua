-- The functions that ArduPilot calls.

local is_enabled = true
local last_call -- the time of the last call on the autopilot's clock
local sent_us, logged_bin, settings_us = LONG_US, -1, 0
local has_failed = false

-- FRISK_ENABLE = 0 silences the script.
local function read_parameters()
  local enable = param:get("FRISK_ENABLE")
  is_enabled = enable == nil or enable > 0
-- @if warn_risk
  warn_risk = param:get("FRISK_WARN") or WARN_RISK
-- @end
-- @if fail_risk
  fail_risk = param:get("FRISK_FAIL") or FAIL_RISK
-- @end
end

local function update()
  local now = micros()
  held_us = last_call and (now - last_call):toint() or 0
  if held_us < 0 or held_us > LONG_US then
    held_us = LONG_US
  end
  if not last_call then
    read_parameters()
  elseif held_us == 0 then
    return
  end
  last_call = now
  held_s = held_us * 1e-6
  -- Limits and parameters may change on the ground.
  settings_us = later(settings_us, held_us)
  if not flown_us and settings_us >= 1000000 then
    settings_us = 0
    read_parameters()
    read_limits()
  end
  if not is_enabled then
    return
  end
  local before = level_now()
  local risk = fly()
  local level = level_now()
  if level ~= before and flown_us and not down_us then
    say(level, risk, false)
  end
-- @if notices
  -- A notice that does not change the level is reported, too.
  if raised and level == before and flown_us and not down_us then
    say(level, risk, true)
  end
  raised = false
-- @end
  sent_us = later(sent_us, held_us)
  if risk and sent_us >= SEND_US then
    sent_us = 0
    gcs:send_named_float("FR_RISK", risk)
    gcs:send_named_float("FR_ELEV", elevated)
  end
  if risk and logged_bin ~= bin then
    logged_bin = bin
    logger:write("FRSK", "Risk,Elev,Level", "ffB", risk, elevated, level)
  end
end

-- Catches errors: an error that is not caught would stop the script and block arming.
function protected()
  local is_well, told = pcall(update)
  if is_well then
    return protected, CALL_MS
  end
  if not has_failed then
    has_failed = true
    gcs:send_text(ERROR, sub("FLAGRED failed: " .. tostring(told), 1, 50))
  end
  pcall(forget)
  return protected, 1000
end

-- The first call, after the memory of the loader was freed. Checks that enough memory remains for the temporary values of calls.
function begin()
  begin = nil
  if not pcall(rep, " ", RESERVE_BYTES) then
    gcs:send_text(ERROR, "FLAGRED is off: increase SCR_HEAP_SIZE")
    return
  end
  gcs:send_text(INFO, format("FLAGRED: %d motors, %.0f to %.0f us", motors, read_limits()))
  return protected, CALL_MS
end
