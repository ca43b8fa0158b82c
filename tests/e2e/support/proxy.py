"""Stands between a client and the daemon, and does what networks do."""

import http.client
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


class Proxy:
    """Passes requests on, but where `fault(method, path)` gives a status to answer with, or "drop" to hang up."""

    def __init__(self, port, fault):
        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def pass_on(self):
                wrong = fault(self.command, self.path)
                body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
                if wrong == "drop":
                    self.close_connection = True
                    return
                if wrong:
                    status, kind, content = wrong, "application/problem+json", b'{"code":"away","detail":"not now"}'
                else:
                    line = http.client.HTTPConnection("127.0.0.1", port, timeout=120)
                    headers = {k: v for k, v in self.headers.items() if k.lower() not in ("host", "connection")}
                    line.request(self.command, self.path, body, headers)
                    answer = line.getresponse()
                    status, kind, content = answer.status, answer.getheader("Content-Type", ""), answer.read()
                    line.close()
                self.send_response(status)
                self.send_header("Content-Type", kind)
                self.send_header("Content-Length", str(len(content)))
                self.send_header("Connection", "close")
                self.end_headers()
                self.wfile.write(content)
                self.close_connection = True

            do_GET = do_POST = do_PUT = pass_on

            def log_message(self, *args):
                pass

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_address[1]}"
        self.thread = threading.Thread(target=self.server.serve_forever, daemon=True)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *reason):
        self.server.shutdown()
        self.server.server_close()
