-- A flight.

flown_us = nil -- time since take-off; nil on the ground
down_us = nil -- how long the vehicle has seemed to be on the ground
local settled, settling = false, huge -- whether the take-off is dropped, and the window to drop it from next
local idle -- why the motors idle: "landing" or "trouble"
local lifted_us -- time since the motors last did not idle; nil if the land detector has reported the ground since then
falls = false -- whether the motors idle in the air
local since_high_us, unknown_us -- time since the risk was last high, and since it was last known

-- Resets the state after a flight or a gap. After a gap in the air, the trims are kept, and an alarm lasts until recovery.
function forget(is_gap)
  lifted_us = not is_gap and lifted_us or nil
  local was_alarm = is_gap and level_now() > GOOD
  for _, window in ipairs(windows) do
    clear(window)
  end
  flown_us, down_us, settled, settling, idle, since_high_us, unknown_us = nil, nil, false, huge, nil, nil, nil
  value = {}
-- @if notices
  forget_notices()
-- @end
-- @if noise
  forget_noise()
-- @end
  stop_judging()
  ok_us = was_alarm and 0 or nil
-- @if imbalance
  if not is_gap then
    forget_trims()
  end
-- @end
end

-- Whether the vehicle is on the ground: the land detector reports it, or the motors idle before take-off or after a flight that
-- was calm to its end. While the command of a motor is unknown, the vehicle counts as in the air.
local function rests()
  local fell = falls
  falls = false
  if not vehicle:get_likely_flying() then
    lifted_us = nil
    return true
  end
  if not sum then
    return false
  end
  if sum >= IDLE_BELOW * motors then
    idle, lifted_us = nil, 0
    return false
  end
  -- While the level is not GOOD, a new fall is not detected: the risk is that of the rules.
  falls = (fell or risk_level == GOOD) and lifted_us ~= nil and lifted_us >= 3000000
  if not idle then
    local is_trouble = since_high_us and since_high_us <= 2000000
-- @if imbalance
    is_trouble = is_trouble or not is_together()
-- @end
    idle = is_trouble and "trouble" or "landing"
  end
  return idle == "landing" and not falls
end

-- Some time after take-off, drops the take-off from the elevated risk and from the long windows, one window per call.
local function settle()
  if not settled and flown_us >= TAKE_OFF_US + WARM_UP_US then
    settled, settling = true, 1
    if TAKE_OFF_US > 0 then
      clear_elevated()
    end
  end
  while TAKE_OFF_US > 0 and settling <= #windows do
    local window = windows[settling]
    settling = settling + 1
    if window.length_us > TAKE_OFF_US then
      local samples = window.samples
      drop_older(window, flown_us - TAKE_OFF_US - 1)
      -- The remaining slots contain several samples each; calls are frequent enough for at least this number.
      window.samples = max(window.samples, min(samples, MIN_SAMPLES))
      return
    end
  end
end

-- Processes the time and the motors; returns the risk in %, nil if it is unknown.
function fly()
  has_moved = false
  clock_us = clock_us + held_us
  bin_us = bin_us + held_us
  bin, bin_us = bin + bin_us // BIN_US, bin_us % BIN_US
  if held_us > LONGEST_GAP_US then
    forget(true)
    held_us, held_s = 0, 0.0
  end
  for _, window in ipairs(windows) do
    local phase = window.phase + SLOTS * held_us
    window.number = window.number + phase // window.length_us
    window.phase = phase % window.length_us
  end
  since_high_us = since_high_us and later(since_high_us, held_us)
  unknown_us = unknown_us and later(unknown_us, held_us)
  ok_us = ok_us and later(ok_us, held_us)
  flown_us = flown_us and later(flown_us, held_us)
  lifted_us = lifted_us and later(lifted_us, held_us)
-- @if if_missing
  note_signals()
-- @end
  read_commands()
-- @if noise
  take_noise()
-- @end
  if rests() then
    value = {}
    if flown_us then
      down_us = down_us and later(down_us, held_us) or 0
      if down_us >= 1000000 then
        forget(false)
      end
    else
      -- The vehicle may have landed during a gap.
      ok_us = nil
-- @if imbalance
      forget_trims()
-- @end
    end
    return nil
  end
  down_us = nil
  flown_us = flown_us or 0
  observe()
  settle()
-- @if notices
  if settled then
    notice()
  end
-- @end
  local is_known = read_inputs()
-- @if needs_motors
  -- While the command of a motor is unknown, so is the risk.
  is_known = is_known and sum
-- @end
  local risk = is_known and estimate()
-- @if needs_motors
  risk = falls and 100.0 or risk
-- @else
  falls = false
-- @end
  if not risk then
    if unknown_us and unknown_us > LONGEST_GAP_US then
      ok_us = level_now() > GOOD and unknown_us or nil
      stop_judging()
      unknown_us = nil
    end
    return nil
  end
  unknown_us = 0
  if warn_risk and risk >= warn_risk then
    since_high_us = 0
  end
  add_up(risk)
  judge(risk, flown_us < QUIET_US and not falls)
  return risk
end
