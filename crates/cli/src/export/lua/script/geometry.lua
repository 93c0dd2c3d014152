-- The geometry of the motors, read once.

-- The frames of ArduPilot: class and type, name, and number, roll, pitch and yaw factor of each motor. One text, since many
-- short ones take more memory to load.
local FRAMES = [[

-- @put frames
]]

-- Solves four equations by elimination with pivots; nil if they have no unique solution.
local function solve(rows, right)
  for step = 1, 4 do
    local pivot = step
    for row = step + 1, 4 do
      if abs(rows[row][step]) > abs(rows[pivot][step]) then
        pivot = row
      end
    end
    if abs(rows[pivot][step]) < 1e-6 then
      return nil
    end
    rows[step], rows[pivot] = rows[pivot], rows[step]
    right[step], right[pivot] = right[pivot], right[step]
    for row = step + 1, 4 do
      local factor = rows[row][step] / rows[step][step]
      for column = step, 4 do
        rows[row][column] = rows[row][column] - factor * rows[step][column]
      end
      right[row] = right[row] - factor * right[step]
    end
  end
  for step = 4, 1, -1 do
    for column = step + 1, 4 do
      right[step] = right[step] - rows[step][column] * right[column]
    end
    right[step] = right[step] / rows[step][step]
  end
  return right
end

-- The effort about an axis (1 roll, 2 pitch, 3 yaw, 4 thrust) per unit of command of each motor: the row of this axis in the
-- pseudo-inverse of all factors.
local function shares_of(factors, axis)
  local rows, right = {}, {0.0, 0.0, 0.0, 0.0}
  for a = 1, 4 do
    rows[a] = {0.0, 0.0, 0.0, 0.0}
    local acts = false
    for _, motor in ipairs(factors) do
      for b = 1, 4 do
        rows[a][b] = rows[a][b] + motor[a] * motor[b]
      end
      acts = acts or motor[a] ~= 0
    end
    if not acts then
      rows[a][a] = 1.0
    end
  end
  right[axis] = 1.0
  local solved = solve(rows, right)
  local shares = {}
  for i, motor in ipairs(factors) do
    if not solved then
      return nil
    end
    shares[i] = motor[1] * solved[1] + motor[2] * solved[2] + motor[3] * solved[3] + motor[4] * solved[4]
  end
  return shares
end

-- @if imbalance
-- Finds the opposite motor of each motor. If two motors share the opposite arm, it is the one that turns the same way.
local function find_opposites(factors)
  for i, motor in ipairs(factors) do
    local least = huge
    for other, factor in ipairs(factors) do
      if abs(factor[1] + motor[1]) < 0.1 and abs(factor[2] + motor[2]) < 0.1 then
        local is_in_the_middle = abs(motor[1]) < 0.1 and abs(motor[2]) < 0.1
        local turns = abs(factor[3] - motor[3])
        if has_geometry and not is_in_the_middle and turns < least then
          least, opposite[i] = turns, other
        end
      end
    end
  end
end

-- @end
local function read_geometry()
  local class, kind = param:get("FRAME_CLASS"), param:get("FRAME_TYPE")
  local frame = class and kind and match(FRAMES, format("\n%.0f/%.0f [^:]* (%%d+: [^\n]*)", class, kind))
  local factors, known = {}, 0
  for number, roll, pitch, yaw in gmatch(frame or "", "(%d+): (%S+) (%S+) (%S+)") do
    known = known + 1
    for i = 1, motors do
      if numbers[i] == tonumber(number) then
        factors[i] = {tonumber(roll) + 0.0, tonumber(pitch) + 0.0, tonumber(yaw) + 0.0, 1.0}
      end
    end
  end
  if #factors ~= motors or known ~= motors then
    gcs:send_text(INFO, "FLAGRED: frame unknown, turns add risk")
    return
  end
-- @put read_efforts
-- @put all_efforts
  for i = 1, motors do
    yaw_factor[i] = factors[i][3]
  end
-- @if imbalance
  find_opposites(factors)
-- @end
end

read_geometry()
