"""Who may see anything: those who know the token; and with which headers it goes out."""

from __future__ import annotations

import hmac

from aiohttp import web

TOKEN = web.AppKey("token", str)
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-cache",
}


def refuse_strangers(request: web.Request) -> None:
    """HTTPForbidden for a request without the token."""
    if not hmac.compare_digest(request.query.get("token", "").encode(), request.app[TOKEN].encode()):
        raise web.HTTPForbidden(text="the address needs the token that was printed")
