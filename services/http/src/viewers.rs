//! Pages elsewhere that may read some of what is served, such as viewers of recordings (Fetch standard, CORS protocol).

use crate::policy::Policy;
use axum::http::header::{
    ACCESS_CONTROL_ALLOW_ORIGIN, ACCESS_CONTROL_EXPOSE_HEADERS, HeaderName, ORIGIN, VARY,
};
use axum::http::{HeaderMap, HeaderValue};
use axum::response::Response;

/// Marks an answer that viewers elsewhere may read, where the configuration names them: `Extension(ForViewers)`.
#[derive(Clone, Copy, Debug)]
pub struct ForViewers;

/// A page elsewhere that the configuration names.
pub(crate) struct Viewer(HeaderValue);

impl Viewer {
    /// The origin of this request, when it is that of a viewer.
    pub(crate) fn of(request: &HeaderMap, policy: &Policy) -> Option<Self> {
        let origin = request.get(ORIGIN)?;
        policy.viewers.iter().any(|viewer| *origin == viewer.as_str()).then(|| Self(origin.clone()))
    }

    /// Lets the viewer read an answer that is marked for viewers. A request for a part of a file needs no preflight.
    pub(crate) fn admit(self, response: &mut Response) {
        const RESOURCE_POLICY: HeaderName = HeaderName::from_static("cross-origin-resource-policy");
        if response.extensions().get::<ForViewers>().is_none() {
            return;
        }
        let exposed = "accept-ranges, content-length, content-range, etag";
        let headers = response.headers_mut();
        headers.insert(ACCESS_CONTROL_ALLOW_ORIGIN, self.0);
        headers.insert(ACCESS_CONTROL_EXPOSE_HEADERS, HeaderValue::from_static(exposed));
        headers.insert(VARY, HeaderValue::from_static("origin"));
        headers.insert(RESOURCE_POLICY, HeaderValue::from_static("cross-origin"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::Body;

    fn allowed(origin: &'static str, mark: Option<ForViewers>) -> Option<HeaderValue> {
        let policy = Policy { viewers: vec!["https://viewer.example".into()], ..Policy::default() };
        let request = HeaderMap::from_iter([(ORIGIN, HeaderValue::from_static(origin))]);
        let mut response = Response::new(Body::empty());
        if let Some(mark) = mark {
            response.extensions_mut().insert(mark);
        }
        Viewer::of(&request, &policy)?.admit(&mut response);
        response.headers().get(ACCESS_CONTROL_ALLOW_ORIGIN).cloned()
    }

    #[test]
    fn only_named_viewers_read_and_only_what_is_marked() {
        assert_eq!(allowed("https://viewer.example", Some(ForViewers)).unwrap(), "https://viewer.example");
        assert_eq!(allowed("https://viewer.example", None), None);
        assert_eq!(allowed("https://other.example", Some(ForViewers)), None);
        assert_eq!(allowed("null", Some(ForViewers)), None);
    }
}
