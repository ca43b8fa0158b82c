// The page has four places: the home (form and list of jobs), one job, the list
// of batches and one batch. All are served from the same index.html, so the path alone decides.

export type Route =
  | { page: "home" } | { page: "job"; id: string }
  | { page: "batches" } | { page: "batch"; id: string };

export function parse_route(path: string): Route {
  if (/^\/batches\/?$/.test(path)) return { page: "batches" };
  const match = /^\/(job|batche)s\/([^/]+)\/?$/.exec(path);
  if (!match?.[2]) return { page: "home" };
  try {
    return { page: match[1] === "job" ? "job" : "batch", id: decodeURIComponent(match[2]) };
  } catch {
    return { page: "home" }; // a malformed percent escape names nothing
  }
}

export function route_path(route: Route): string {
  switch (route.page) {
    case "home": return "/";
    case "batches": return "/batches";
    case "job": return `/jobs/${encodeURIComponent(route.id)}`;
    case "batch": return `/batches/${encodeURIComponent(route.id)}`;
  }
}

export function same_route(a: Route, b: Route): boolean {
  return route_path(a) === route_path(b);
}
