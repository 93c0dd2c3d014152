-- What the pilot reads, in at most 50 characters.

function level_now()
  local level = risk_level
-- @if reserve
  level = little_reserve and max(level, WARN) or level
-- @end
-- @if imbalance
  level = (imbalance or weak) and max(level, WARN) or level
-- @end
  return doubt_us and max(level, WARN) or level
end

-- A cause in two parts; where there is no room for the last one, the first one is true alone.
function cause_in_words()
  local about = cause and CAUSES[cause]
  if not about then
    return ", interpolated", ""
  end
-- @if motor_cause
  if limit_motor then
    local side = is_upper[limit_motor] and "upper" or "lower"
    return ", " .. side .. " limit", format(", motor %d", numbers[limit_motor])
  end
-- @end
  return ", " .. about[3], about[4]
end

