//! Judges a request by its header alone: is it meant for us, does it come from our page, may it change things.

use crate::counters::Refusal;
use crate::policy::{Access, Policy};
use crate::problem::Problem;
use axum::http::header::{AUTHORIZATION, HOST, ORIGIN};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName, Method, StatusCode, Uri};
use std::net::IpAddr;

/// Judges one request; `own_name` is the machine's name.
pub(crate) fn judge(parts: &Parts, policy: &Policy, access: Access, own_name: &str) -> Result<(), Problem> {
    check_query(&parts.uri, policy.max_query_bytes)?;
    let host = check_host(parts, policy, own_name)?;
    if is_change(&parts.method) {
        check_origin(&parts.headers, &host)?;
        check_permission(&parts.headers, policy, access)?;
    }
    Ok(())
}

/// Whether a method may change something (RFC 9110 section 9.2.1 lists the safe ones).
pub(crate) fn is_change(method: &Method) -> bool {
    !matches!(*method, Method::GET | Method::HEAD | Method::OPTIONS)
}

fn refuse(refusal: Refusal, status: StatusCode, detail: String) -> Problem {
    Problem::new(status, detail).because(refusal)
}

fn check_query(uri: &Uri, max_query_bytes: usize) -> Result<(), Problem> {
    let length = uri.query().map_or(0, str::len);
    if length <= max_query_bytes {
        return Ok(());
    }
    let detail = format!("the query has {length} bytes; allowed are {max_query_bytes}");
    Err(refuse(Refusal::Query, StatusCode::URI_TOO_LONG, detail))
}

/// Refuses names that are not ours, so that a page elsewhere cannot reach us by rebinding its own name.
fn check_host(parts: &Parts, policy: &Policy, own_name: &str) -> Result<String, Problem> {
    let authority = parts.uri.authority().map(|authority| authority.as_str());
    let header = parts.headers.get(HOST).and_then(|host| host.to_str().ok());
    let Some(host) = authority.or(header) else {
        let detail = "the request has no Host header (RFC 9112 section 3.2)".to_owned();
        return Err(refuse(Refusal::Host, StatusCode::BAD_REQUEST, detail));
    };
    if is_own_host(host, policy, own_name) {
        return Ok(host.to_ascii_lowercase());
    }
    let detail = format!(
        "{host:?} is not a name of this service; use its IP address, localhost or {own_name:?}, \
         or list the name in http.hosts"
    );
    Err(refuse(Refusal::Host, StatusCode::FORBIDDEN, detail))
}

fn is_own_host(host: &str, policy: &Policy, own_name: &str) -> bool {
    let name = without_port(host).trim_end_matches('.').to_ascii_lowercase();
    let literal = name.trim_start_matches('[').trim_end_matches(']');
    let own = own_name.to_ascii_lowercase();
    literal.parse::<IpAddr>().is_ok()
        || name == "localhost"
        || name.ends_with(".localhost")
        || (!own.is_empty() && (name == own || name == format!("{own}.local")))
        || policy.hosts.iter().any(|listed| listed.eq_ignore_ascii_case(&name))
}

fn without_port(host: &str) -> &str {
    if let Some(end) = host.find(']') {
        return &host[..=end];
    }
    host.rsplit_once(':').map_or(host, |(name, _)| name)
}

/// A browser says where a change comes from; only our own page may (RFC 6454, Fetch Metadata).
fn check_origin(headers: &HeaderMap, host: &str) -> Result<(), Problem> {
    const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");
    let cross_site = headers.get(SEC_FETCH_SITE).is_some_and(|site| site != "same-origin" && site != "none");
    let foreign = headers.get(ORIGIN).is_some_and(|origin| {
        let authority = origin.to_str().ok().and_then(|text| text.split_once("://")).map(|(_, rest)| rest);
        !authority.is_some_and(|authority| authority.eq_ignore_ascii_case(host))
    });
    if !cross_site && !foreign {
        return Ok(());
    }
    let detail = "changes are taken from this service's own page or from programs, not from other sites";
    Err(refuse(Refusal::Origin, StatusCode::FORBIDDEN, detail.to_owned()))
}

fn check_permission(headers: &HeaderMap, policy: &Policy, access: Access) -> Result<(), Problem> {
    let presented = headers
        .get(AUTHORIZATION)
        .and_then(|value| value.to_str().ok())
        .and_then(|value| value.split_once(' '))
        .filter(|(scheme, _)| scheme.eq_ignore_ascii_case("bearer"))
        .map(|(_, token)| token.trim());
    match (access, &policy.token, presented) {
        (Access::Open, _, _) => Ok(()),
        (Access::Token, Some(token), Some(presented)) if token.matches(presented) => Ok(()),
        (Access::Token, _, _) => {
            let detail = "changes need the header `Authorization: Bearer` with the token of --token-file";
            Err(refuse(Refusal::Token, StatusCode::UNAUTHORIZED, detail.to_owned()))
        }
        (Access::ReadOnly, _, _) => {
            let detail = "read-only: other machines can connect and no token is set; start with --token-file \
                          or listen on 127.0.0.1";
            Err(refuse(Refusal::ReadOnly, StatusCode::FORBIDDEN, detail.to_owned()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policy::Token;
    use axum::http::Request;

    fn verdict(
        method: &str,
        headers: &[(&str, &str)],
        policy: &Policy,
        access: Access,
    ) -> Option<(&'static str, u16)> {
        let mut request = Request::builder().method(method).uri("/api/v1/recorder");
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let (parts, ()) = request.body(()).unwrap().into_parts();
        judge(&parts, policy, access, "rover")
            .err()
            .map(|problem| (problem.refusal.map_or("", Refusal::name), problem.status().as_u16()))
    }

    #[test]
    fn hosts_are_ip_literals_localhost_the_machine_or_listed() {
        let policy = Policy { hosts: vec!["convoy.example".into()], ..Policy::default() };
        let own = [
            "127.0.0.1:8080",
            "[::1]:8080",
            "10.0.0.7",
            "localhost:1",
            "Rover:80",
            "rover.local",
            "convoy.example:443",
        ];
        for host in own {
            assert_eq!(verdict("GET", &[("host", host)], &policy, Access::Open), None, "{host}");
        }
        for host in
            ["evil.example", "rover.evil.example", "127.0.0.1.evil.example", "localhost.evil.example", ""]
        {
            assert_eq!(
                verdict("GET", &[("host", host)], &policy, Access::Open),
                Some(("host", 403)),
                "{host}"
            );
        }
        assert_eq!(verdict("GET", &[], &policy, Access::Open), Some(("host", 400)));
    }

    #[test]
    fn changes_come_from_our_own_page_or_from_programs() {
        let judge = |headers: &[(&str, &str)]| {
            let mut all = vec![("host", "127.0.0.1:8080")];
            all.extend_from_slice(headers);
            verdict("POST", &all, &Policy::default(), Access::Open)
        };
        assert_eq!(judge(&[]), None);
        assert_eq!(judge(&[("origin", "http://127.0.0.1:8080")]), None);
        assert_eq!(judge(&[("origin", "http://127.0.0.1:9090")]), Some(("origin", 403)));
        assert_eq!(judge(&[("origin", "https://evil.example")]), Some(("origin", 403)));
        assert_eq!(judge(&[("origin", "null")]), Some(("origin", 403)));
        assert_eq!(judge(&[("sec-fetch-site", "cross-site")]), Some(("origin", 403)));
    }

    #[test]
    fn changes_need_the_token_or_loopback() {
        let guarded = Policy { token: Token::new("0123456789abcdef"), ..Policy::default() };
        let host = ("host", "10.0.0.7:8080");
        let with =
            |value: &'static str| verdict("POST", &[host, ("authorization", value)], &guarded, Access::Token);
        assert_eq!(with("Bearer 0123456789abcdef"), None);
        assert_eq!(with("bearer 0123456789abcdef"), None);
        assert_eq!(with("Bearer wrong"), Some(("token", 401)));
        assert_eq!(with("Basic 0123456789abcdef"), Some(("token", 401)));
        assert_eq!(
            verdict("DELETE", &[host], &Policy::default(), Access::ReadOnly),
            Some(("read_only", 403))
        );
        assert_eq!(verdict("GET", &[host], &Policy::default(), Access::ReadOnly), None);
    }
}
