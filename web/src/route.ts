// The page has two places: the home (form and list of jobs) and one job.
// Both are served from the same index.html, so the path alone decides.

export type Route = { page: "home" } | { page: "job"; id: string };

export function parse_route(path: string): Route {
  const match = /^\/jobs\/([^/]+)\/?$/.exec(path);
  if (!match?.[1]) return { page: "home" };
  try {
    return { page: "job", id: decodeURIComponent(match[1]) };
  } catch {
    return { page: "home" }; // a malformed percent escape names no job
  }
}

export function route_path(route: Route): string {
  return route.page === "home" ? "/" : `/jobs/${encodeURIComponent(route.id)}`;
}

export function same_route(a: Route, b: Route): boolean {
  return route_path(a) === route_path(b);
}
