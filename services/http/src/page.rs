//! The inspection page, embedded at build time from `web/`.

use crate::conditional::{conditional, entity_tag, tag_from_digest};
use crate::problem::Problem;
use axum::Router;
use axum::body::Bytes;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use rust_embed::RustEmbed;
use std::borrow::Cow;

#[derive(RustEmbed)]
#[folder = "../../web"]
#[exclude = "node_modules/*"]
#[include = "*.html"]
#[include = "*.css"]
#[include = "*.js"]
#[include = "*.svg"]
struct Files;

/// What the build fetched from npm, or what says that it did not.
const FETCHED: [(&str, &[u8]); 2] = [
    ("uplot.js", include_bytes!(concat!(env!("OUT_DIR"), "/uplot.js"))),
    ("uplot.css", include_bytes!(concat!(env!("OUT_DIR"), "/uplot.css"))),
];

/// Routes for the page: `/` and a route for each file it loads, with entity tags. Nothing else is served.
pub fn page() -> Router {
    let files = Files::iter().map(|name| (format!("/{name}"), name.into_owned()));
    let aliases = [("/", "index.html"), ("/favicon.ico", "icon.svg")];
    let aliases = aliases.map(|(path, name)| (path.to_owned(), name.to_owned()));
    let router = FETCHED.into_iter().fold(Router::new(), |router, (name, content)| {
        let answer = async move |headers: HeaderMap| {
            conditional(&headers, &entity_tag(content), content_type(name), Bytes::from_static(content))
        };
        router.route(&format!("/{name}"), get(answer))
    });
    files.chain(aliases).fold(router, |router, (path, name)| {
        router.route(&path, get(async move |headers: HeaderMap| file(&name, &headers)))
    })
}

/// Names are looked up among the embedded ones exactly as they stand; no file system is involved.
fn file(name: &str, request: &HeaderMap) -> Response {
    let Some(file) = Files::get(name) else {
        return Problem::not_found("page or file at this address").into_response();
    };
    let content = match file.data {
        Cow::Borrowed(bytes) => Bytes::from_static(bytes),
        Cow::Owned(bytes) => Bytes::from(bytes),
    };
    conditional(request, &tag_from_digest(&file.metadata.sha256_hash()), content_type(name), content)
}

fn content_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_embedded_and_names_are_exact() {
        let request = HeaderMap::new();
        assert_eq!(file("index.html", &request).status(), 200);
        for name in ["../Cargo.toml", "./index.html", "index.html\0", "/etc/passwd", "%2e%2e/Cargo.toml", ""]
        {
            assert_eq!(file(name, &request).status(), 404, "{name:?}");
        }
    }
}
