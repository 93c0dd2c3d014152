/** An example flight: a simulated octocopter that a gust nearly overturns. Loaded on demand. */

import gust from './gust.csv.gz';

export const example = (): File => new File([gust], 'octocopter-in-a-gust.csv.gz');
