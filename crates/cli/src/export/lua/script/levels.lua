-- Levels, which are raised after some time, held, and lowered after some time.

-- For each rule: area and centre of its consequent, two texts for the pilot, and whether its cause is motors near a limit.
CAUSES = {
-- @put causes
}
-- @if leads
-- For a cause that is the value of another output: the numbers of that output's rules, each with a factor for its contribution.
local LEADS = {
-- @put leads
}
-- @end
warn_risk, fail_risk = WARN_RISK, FAIL_RISK -- parameters may change them
risk_level = GOOD -- of the risk alone
local reached_at = {} -- the time since which the threshold of each level has been reached
local held_at = 0 -- the last time at which the risk held the level
is_open, by_elevated, by_fall = false, false, false -- whether a finding is open, and whether elevated risk or a fall raised it
local open_level = GOOD
-- @if motor_cause
local seen, mean_margin, least_margin = 0, {}, {} -- margins of the motors since a threshold was first reached
is_upper = {} -- whether the limit that each motor was nearest to is the upper one
-- @end

-- The rule that raises the risk most: the one with the largest product of strength, area and (centre - risk / 2).
local function find_cause(risk)
  if is_filled then
    return nil
  end
  local most, rule = -huge, nil
  for i = 1, #CAUSES do
    local about, strength = CAUSES[i], fired[i] or 0.0
    if about and about[1] > 0 and strength > 0 then
      local raises = strength * about[1] * (about[2] - risk / 2)
      if raises > most then
        most, rule = raises, i
      end
    end
  end
-- @if leads
  while rule and CAUSES[rule][6] do
    local leads = LEADS[CAUSES[rule][6]]
    most, rule = 0.0, nil
    for i = 1, #leads, 2 do
      local share = (fired[leads[i]] or 0.0) * leads[i + 1]
      if share > most then
        most, rule = share, leads[i]
      end
    end
  end
-- @end
  return rule
end

local function is_reached(risk, risk_limit, elevated_limit)
  if risk_limit and risk >= risk_limit then
    return true, false
  elseif elevated_limit and elevated >= elevated_limit then
    return true, true
  end
  return false, false
end

-- @if motor_cause
-- The motor with the least mean margin; nil if it is not near a limit. Among motors at zero, the one that stopped first.
local function weakest()
  local found
  for i = 1, motors do
    local margin, least = mean_margin[i], found and mean_margin[found]
    if margin and (not found or margin < least) then
      found = i
-- @if imbalance
    elseif margin == least and margin and (at_zero[found] or 0.0) > 0 and at_zero[i] > at_zero[found] then
      found = i
-- @end
    end
  end
  return found and least_margin[found] < 0.1 and found or nil
end

-- @end
local function raise(level, of_elevated, risk)
  risk_level = level
  if not is_open or open_level ~= level then
    by_elevated, by_fall = of_elevated, falls
  end
  if not is_open or level > open_level then
    cause, open_level = not falls and find_cause(risk) or nil, level
-- @if motor_cause
    limit_motor = cause and CAUSES[cause][5] and weakest()
-- @end
  end
  is_open = true
end

-- Raises a level if its threshold has been reached for long enough. Returns the highest level that the risk holds so far.
local function follow(level, held, risk, can_raise, risk_limit, elevated_limit, after_us, until_risk, until_elevated)
  local reached, of_elevated = is_reached(risk, risk_limit, elevated_limit)
  reached = reached and can_raise
  if reached or is_reached(risk, until_risk, until_elevated) then
    held = min(level, risk_level)
  end
  if not reached then
    reached_at[level] = nil
    return held
  end
  reached_at[level] = reached_at[level] or clock_us
  if level > risk_level and clock_us - reached_at[level] >= after_us then
    raise(level, of_elevated, risk)
    held = level
  end
  return held
end
-- @if motor_cause

-- Records the margins of the motors while the threshold of a level is reached, from the time at which it is first reached.
local function watch_motors(risk, takes_off)
  local warns = not takes_off and is_reached(risk, warn_risk, WARN_ELEVATED)
  local fails = is_reached(risk, fail_risk, FAIL_ELEVATED)
-- @if imbalance
  fails = fails and (falls or not sinks)
-- @end
  if not warns and not fails then
    return
  end
  if warns and not reached_at[WARN] or fails and not reached_at[FAIL] then
    seen, mean_margin, least_margin = 0, {}, {}
  end
  seen = seen + 1
  for i = 1, motors do
    local e = command[i]
    local near = e < 0.5 and e or 1 - e
    local mean = mean_margin[i] or 0.0
    mean_margin[i] = mean + (near - mean) / seen
    if near < (least_margin[i] or huge) then
      least_margin[i], is_upper[i] = near, e >= 0.5
    end
  end
end
-- @end

-- The risk that holds a level: not above the risk that raises it, which a parameter may have lowered.
local function lower(until_risk, risk)
  return until_risk and risk and min(until_risk, risk) or until_risk
end

ok_us = nil -- after an alarm: how long the motors have worked as before it

-- After an alarm, the level is GOOD again once the motors have worked as before it for the time after which a level is cleared.
local function check_recovery()
  local ok = true
-- @if imbalance
  ok = works_as_before()
-- @end
  if (risk_level > GOOD or ok_us) and not ok then
    ok_us = 0
  elseif risk_level == GOOD and ok_us and ok_us >= CLEAR_AFTER_US then
    ok_us = nil
  end
end

function judge(risk, takes_off)
-- @if motor_cause
  watch_motors(risk, takes_off)
-- @end
  local held, can_fail = GOOD, true
-- @if imbalance
  can_fail = falls or not sinks
-- @end
  local warn_until, fail_until = lower(WARN_UNTIL_RISK, warn_risk), lower(FAIL_UNTIL_RISK, fail_risk)
  held = follow(WARN, held, risk, not takes_off, warn_risk, WARN_ELEVATED, WARN_AFTER_US, warn_until, WARN_UNTIL_ELEVATED)
  held = follow(FAIL, held, risk, can_fail, fail_risk, FAIL_ELEVATED, FAIL_AFTER_US, fail_until, FAIL_UNTIL_ELEVATED)
  if held >= risk_level then
    held_at = clock_us
  elseif clock_us - held_at >= CLEAR_AFTER_US then
    risk_level, held_at = held, clock_us
    is_open = held > GOOD
  end
  check_recovery()
end

function stop_judging()
  clear_elevated()
  risk_level, is_open = GOOD, false
  reached_at[WARN], reached_at[FAIL] = nil, nil
end
