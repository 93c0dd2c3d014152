-- What is told beside the risk, as WARN until the flight ends.

raised = false -- whether something was raised in this call

-- A moving average; until its time constant has passed, the plain mean.
local function new_average()
  return {value = 0.0, known = 0.0}
end

local function average(mean, x, constant_s)
  if held_s > 0 then
    mean.known = mean.known + held_s
    local share = held_s / max(min(mean.known, constant_s), held_s)
    mean.value = mean.value + (x - mean.value) * share
  end
end
-- @if reserve

local reserve, reserve_us = new_average(), nil
little_reserve = nil

local function watch_reserve(mean)
  average(reserve, 1 - mean, 3.0)
  if reserve.known < 3.0 or reserve.value >= RESERVE_BELOW then
    reserve_us = nil
    return
  end
  reserve_us = reserve_us and later(reserve_us, held_us) or 0
  if not little_reserve and reserve_us >= RESERVE_AFTER_US then
    raised = true
  end
  if little_reserve or raised then
    little_reserve = min(little_reserve or huge, 100 * reserve.value)
  end
end
-- @end
-- @if imbalance

local difference, trim = {}, {} -- of each motor from the mean of all, lately and as a trim
local settled_us, imbalance_us
imbalance, unbalanced, of_pair = nil, nil, false -- in %, the motor, and whether it is against the one opposite

-- How far a motor is above the one opposite at most, and that motor: a fault from before the trim was learned shows only here.
local function at_odds()
  local most, motor = 0.0, nil
  for i = 1, motors do
    local other = difference[opposite[i]]
    if other and difference[i].known >= 5.0 then
      local above = difference[i].value - other.value
      if not motor or above >= most then
        most, motor = above, i
      end
    end
  end
  return most, motor
end

local function watch_balance(mean)
  settled_us = settled_us and later(settled_us, held_us) or 0
  local most, motor = 0.0, nil
  for i = 1, motors do
    local now, usual = difference[i], trim[i]
    if not now then
      now, usual = new_average(), new_average()
      difference[i], trim[i] = now, usual
    end
    local x = less_yaw[i] - mean
    average(now, x, 5.0)
    local from_trim = now.value - usual.value
    if usual.known < 10.0 or abs(from_trim) < IMBALANCE_ABOVE / 2 then
      average(usual, x, 30.0)
    end
    if not motor or abs(from_trim) > most then
      most, motor = abs(from_trim), i
    end
  end
  local limit, is_pair = IMBALANCE_ABOVE, false
  if most <= limit or settled_us < 10000000 then
    most, motor = at_odds()
    limit, is_pair = 2 * IMBALANCE_ABOVE, true
  end
  if most <= limit then
    imbalance_us = nil
    return
  end
  imbalance_us = imbalance_us and later(imbalance_us, held_us) or 0
  if imbalance then
    imbalance = is_pair == of_pair and max(imbalance, 100 * most) or imbalance
  elseif imbalance_us >= IMBALANCE_AFTER_US then
    imbalance, unbalanced, of_pair, raised = 100 * most, motor, is_pair, true
  end
end
-- @end

function notice()
  raised = false
  if not sum then
    return
  end
-- @if reserve
  watch_reserve(sum / motors)
-- @end
-- @if imbalance
  watch_balance(sum / motors)
-- @end
end

function forget_notices()
-- @if reserve
  reserve, reserve_us, little_reserve = new_average(), nil, nil
-- @end
-- @if imbalance
  difference, trim = {}, {}
  settled_us, imbalance_us, imbalance, unbalanced, of_pair = nil, nil, nil, nil, false
-- @end
end
