/** A flight to try: a simulated octocopter that a gust nearly throws down. Loaded when it is asked for. */

import gust from './gust.csv.gz';

export const example = (): File => new File([gust], 'octocopter-in-a-gust.csv.gz');
