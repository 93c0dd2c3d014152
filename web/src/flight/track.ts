/** The track of a flight over ground: the position at a time. */

export interface Track {
  here: SVGPathElement;
  output: HTMLElement;
  start_s: number;
  /** For each point: seconds since the start, metres to the right, metres down. */
  points: [number, number, number][];
}

/** Finds the track within an element. */
export function trackIn(root: ParentNode): Track | undefined {
  const box = root.querySelector<HTMLElement>('.track');
  const here = box?.querySelector<SVGPathElement>('.here');
  const output = box?.querySelector('output');
  if (!box || !here || !output) return undefined;
  box.querySelector('svg')?.setAttribute('role', 'img');
  const points = (box.dataset['points'] ?? '').split(';').map((point) => point.split(' ').map(Number) as [number, number, number]);
  return { here, output, start_s: Number(box.dataset['start']), points };
}

/** Moves the point of the track to its position at a time, in seconds on the log's clock. */
export function pointTrack({ here, output, start_s, points }: Track, t_s: number): void {
  let low = 0;
  let high = points.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (points[middle]![0] <= t_s - start_s) low = middle + 1;
    else high = middle;
  }
  const [[, firstX, firstY], [, x, y]] = [points[0]!, points[Math.max(low - 1, 0)]!];
  here.setAttribute('d', `M${x} ${y}h0`);
  const [east, north] = [Math.round(x - firstX), Math.round(firstY - y)];
  const across = `${Math.abs(east)} m ${east < 0 ? 'west' : 'east'}`;
  output.textContent = `${Math.abs(north)} m ${north < 0 ? 'south' : 'north'}, ${across} of take-off`;
}
