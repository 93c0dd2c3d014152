-- The rules.

fired = {} -- the firing strengths of rules
local coverage = 0.0 -- the largest firing strength
local strengths, degrees = {}, {} -- of output terms, and of terms in conditions
is_filled = false

-- The degree at x, interpolated between the corners: x1, degree 1, x2, degree 2 and so on.
local function along(corners, x)
  local count = #corners
  if x < corners[1] then
    return corners[2]
  end
  for i = 3, count, 2 do
    if x < corners[i] then
      local left, low = corners[i - 2], corners[i - 1]
      return low + (corners[i + 1] - low) * ((x - left) / (corners[i] - left))
    end
  end
  return corners[count]
end
-- @if maxima

local function fire(rule, term, strength)
  if strength < MIN_STRENGTH then
    strength = 0.0
  end
  if strength > strengths[term] then
    strengths[term] = strength
  end
  fired[rule] = strength
  if strength > coverage then
    coverage = strength
  end
end
-- @end
-- @if sums

local function add(rule, term, strength)
  if strength < MIN_STRENGTH then
    strength = 0.0
  end
  strengths[term] = strengths[term] + strength
  fired[rule] = strength
  if strength > coverage then
    coverage = strength
  end
end
-- @end
-- @put operators

-- @put terms

-- The risk of the rules in %; nil if none fires.
local function by_rules(x)
  coverage = 0.0
  for term = 1, OUTPUT_TERMS do
    strengths[term] = 0.0
  end
-- @put rules
end
-- @if filled

-- Values for gaps between the rules, at knots, with the last input varying fastest; linear interpolation between the knots.
local KNOTS = {
-- @put knots
}
local FILLED = {
-- @put filled
}

local function filled(x, axis, knot)
  local places = KNOTS[axis]
  if not places then
    return FILLED[knot + 1]
  end
  local count, behind = #places, 0
  while behind < count and places[behind + 1] <= x[axis] do
    behind = behind + 1
  end
  local first = knot * count
  if behind == 0 or behind == count then
    return filled(x, axis + 1, first + (behind == 0 and 0 or count - 1))
  end
  local left = places[behind]
  local share = (x[axis] - left) / (places[behind + 1] - left)
  local low = filled(x, axis + 1, first + behind - 1)
  if share == 0 then
    return low
  end
  return (1 - share) * low + share * filled(x, axis + 1, first + behind)
end
-- @end

local point = {} -- the inputs of the rules, in their order, then outputs that others read

function estimate()
-- @put point
  local risk = by_rules(point)
-- @if filled
  -- A coverage that is only just below the limit is a rounding error.
  is_filled = coverage < COVERAGE_BELOW * (1 - 1e-5)
  if is_filled then
    risk = filled(point, 1, 0)
  end
-- @end
  return risk and max(0.0, min(100.0, risk))
end
