/** The service worker: the page works without a network once it was loaded. */

declare const self: ServiceWorkerGlobalScope;
/** Written by the build: the files of the page, and what tells this build from others. */
declare const FILES: string[];
declare const BUILD: string;

self.addEventListener('install', (event) => {
  // What the browser keeps of another build is asked for again.
  const files = FILES.map((file) => new Request(file, { cache: 'no-cache' }));
  event.waitUntil(caches.open(BUILD).then((cache) => cache.addAll(files)).then(() => self.skipWaiting()));
});

self.addEventListener('activate', (event) => {
  const drop = async () => {
    for (const name of await caches.keys()) if (name !== BUILD) await caches.delete(name);
    await self.clients.claim();
  };
  event.waitUntil(drop());
});

self.addEventListener('fetch', (event) => {
  const answer = async () => {
    const cache = await caches.open(BUILD);
    const known = await cache.match(event.request, { ignoreSearch: true });
    return known ?? fetch(event.request);
  };
  if (event.request.method === 'GET') event.respondWith(answer());
});

export {};
