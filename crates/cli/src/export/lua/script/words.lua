-- The level and the cause that the pilot reads, in texts of at most 50 characters.

function level_now()
  local level = risk_level
-- @if reserve
  level = little_reserve and max(level, WARN) or level
-- @end
-- @if imbalance
  level = (imbalance or weak) and max(level, WARN) or level
-- @end
  return ok_us and max(level, WARN) or level
end

-- The cause in two parts; if there is no space for the second part, the first part is used alone.
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

