% Evaluates each FIS of a folder with Octave's fuzzy-logic-toolkit at the points of the table beside it, and compares the values.
%
% octave-cli octave_peer.m FOLDER: for each NAME.fis, NAME.csv has a column for each input and output.
pkg load fuzzy-logic-toolkit

% The algebraic sum under the name that MATLAB uses.
function y = probor (varargin)
  y = algebraic_sum (varargin{:});
endfunction

SAMPLES = 1001;    % per integral; this project integrates exactly
files = glob (fullfile (argv (){end}, '*.fis'));
wrong = 0;
for k = 1:numel (files)
  system = readfis (files{k});
  points = dlmread (strrep (files{k}, '.fis', '.csv'), ',', 1, 0);
  inputs = columns (system.input);
  if strcmp (system.type, 'sugeno')
    largest = 1e-9;
  else
    largest = 1e-3;
  endif
  found = evalfis (points(:, 1:inputs), system, SAMPLES);
  expected = points(:, inputs + 1:end);
  for output = 1:columns (system.output)
    range = system.output(output).range;
    worst = max (abs (found(:, output) - expected(:, output))) / (range(2) - range(1));
    if !(worst <= largest)
      printf ('%s, output %d: %g of the range\n', files{k}, output, worst);
      wrong++;
    endif
  endfor
endfor
printf ('%d rule sets, %d outputs with other values\n', numel (files), wrong);
exit (wrong > 0 || isempty (files));
