-- Notices that are not about the risk. They keep the level at WARN or above until the flight ends.

raised = false -- whether a notice was raised in this call

-- A moving average; until its time constant has passed, it is the plain mean.
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

function notice()
  raised = false
  if not sum then
    return
  end
-- @if reserve
  watch_reserve(sum / motors)
-- @end
-- @if imbalance
  watch_balance()
-- @end
end

function forget_notices()
-- @if reserve
  reserve, reserve_us, little_reserve = new_average(), nil, nil
-- @end
-- @if imbalance
  forget_balance()
-- @end
end
