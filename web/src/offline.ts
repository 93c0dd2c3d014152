/** The service worker: once loaded, the page works without a network. */

declare const self: ServiceWorkerGlobalScope;
/** Set by the build: the files of the page, and an identifier of the build. */
declare const FILES: string[];
declare const BUILD: string;

self.addEventListener('install', (event) => {
  // Files that the browser cached from another build are requested again.
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
