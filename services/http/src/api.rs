//! Routes together with what is said of them, so that `/openapi.json` cannot fall behind, and query parameters that
//! are not said to exist are refused.

mod operation;

pub use operation::{Operation, integer};

use crate::conditional::{conditional, entity_tag};
use crate::parameters::Parameters;
use crate::problem::{Problem, ProblemDocument};
use axum::Router;
use axum::body::Bytes;
use axum::extract::Request;
use axum::http::{HeaderMap, Method};
use axum::middleware::{Next, from_fn};
use axum::response::IntoResponse;
use axum::routing::{MethodRouter, get};
use schemars::SchemaGenerator;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// The methods of a path with the query parameters of each.
type Known = Arc<[(&'static str, Vec<&'static str>)]>;

/// Routes and their description in OpenAPI 3.1.
pub struct Api {
    router: Router,
    paths: Map<String, Value>,
    schemas: SchemaGenerator,
    title: &'static str,
    version: &'static str,
}

impl Api {
    /// No route yet.
    #[must_use]
    pub fn new(title: &'static str, version: &'static str) -> Self {
        let settings = SchemaSettings::draft2020_12().for_serialize().with(|settings| {
            settings.definitions_path = "/components/schemas".into();
            settings.meta_schema = None;
        });
        let schemas = SchemaGenerator::new(settings);
        Self { router: Router::new(), paths: Map::new(), schemas, title, version }
    }

    /// Adds a path: what can be done there, and who does it.
    #[must_use]
    pub fn route(
        mut self,
        path: &str,
        operations: impl IntoIterator<Item = Operation>,
        handlers: MethodRouter,
    ) -> Self {
        let known = self.describe(path, operations);
        self.router = self.router.route(path, strict(handlers, known));
        self
    }

    /// Adds routes that are no part of the interface, such as the files of a page.
    #[must_use]
    pub fn undescribed(mut self, router: Router) -> Self {
        self.router = self.router.merge(router);
        self
    }

    /// All routes, and the description at `/openapi.json`.
    pub fn finish(mut self) -> Router {
        const PATH: &str = "/openapi.json";
        let itself =
            Operation::get("This description").answers("application/json", json!({ "type": "object" }));
        let known = self.describe(PATH, [itself]);
        let document = Bytes::from(self.document().to_string());
        let tag = entity_tag(&document);
        let answer = get(move |request: HeaderMap| async move {
            conditional(&request, &tag, "application/json", document.clone())
        });
        self.router.route(PATH, strict(answer, known))
    }

    fn describe(&mut self, path: &str, operations: impl IntoIterator<Item = Operation>) -> Known {
        let mut item = Map::new();
        let mut known = Vec::new();
        for operation in operations {
            known.push((operation.method(), operation.query_names()));
            item.insert(operation.method().to_owned(), operation.described(path, &mut self.schemas));
        }
        self.paths.insert(path.to_owned(), Value::Object(item));
        known.into()
    }

    fn document(&self) -> Value {
        let mut schemas = self.schemas.clone();
        let problem = schemas.subschema_for::<ProblemDocument>();
        let definitions = schemas.take_definitions(true);
        json!({
            "openapi": "3.1.0",
            "info": { "title": self.title, "version": self.version },
            "paths": self.paths,
            "components": {
                "schemas": definitions,
                "responses": {
                    "Problem": {
                        "description": "Why the request was not answered as asked (RFC 9457)",
                        "content": { "application/problem+json": { "schema": problem } },
                    },
                },
                "securitySchemes": { "token": { "type": "http", "scheme": "bearer" } },
            },
        })
    }
}

/// Handlers that are only asked what they are said to answer.
fn strict(handlers: MethodRouter, known: Known) -> MethodRouter {
    handlers.layer(from_fn(move |request: Request, next: Next| {
        let verdict = check_query(&request, &known);
        async move {
            match verdict {
                Ok(()) => next.run(request).await,
                Err(problem) => problem.into_response(),
            }
        }
    }))
}

/// Refuses parameters that the operation is not said to have.
fn check_query(request: &Request, known: &[(&'static str, Vec<&'static str>)]) -> Result<(), Problem> {
    let method = if request.method() == Method::HEAD { Method::GET } else { request.method().clone() };
    let names = known.iter().find(|(name, _)| method.as_str().eq_ignore_ascii_case(name));
    let Some((_, names)) = names else { return Ok(()) };
    let mut query = Parameters::parse(request.uri().query())?;
    for name in names {
        query.text(name);
    }
    query.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::{Body, to_bytes};
    use axum::routing::post;
    use futures_util::FutureExt;
    use hyper::service::Service;
    use hyper_util::service::TowerToHyperService;

    #[derive(schemars::JsonSchema)]
    #[expect(dead_code, reason = "only its schema is looked at")]
    struct Answer {
        /// How many.
        count: u32,
    }

    fn api() -> Router {
        let read = Operation::get("Counts").query("from", "Where to begin", json!({ "type": "integer" }));
        Api::new("Test", "1")
            .route(
                "/things/{id}",
                [
                    read.path("id", "Which", json!({ "type": "string" })).gives::<Answer>(),
                    Operation::post("Adds").empty(204),
                ],
                get(|| async { "1" }).merge(post(|| async {})),
            )
            .finish()
    }

    fn ask(method: &str, uri: &str) -> (u16, Value) {
        let request = Request::builder().method(method).uri(uri).body(Body::empty()).unwrap();
        let answer = TowerToHyperService::new(api()).call(request).now_or_never().unwrap().unwrap();
        let status = answer.status().as_u16();
        let body = to_bytes(answer.into_body(), 1 << 20).now_or_never().unwrap().unwrap();
        (status, serde_json::from_slice(&body).unwrap_or_default())
    }

    #[test]
    fn only_parameters_that_are_described_are_taken() {
        assert_eq!(ask("GET", "/things/a?from=1").0, 200);
        assert_eq!(ask("HEAD", "/things/a?from=1").0, 200);
        assert_eq!(ask("GET", "/things/a?to=1").0, 400);
        assert_eq!(ask("POST", "/things/a?from=1").0, 400);
        assert_eq!(ask("PUT", "/things/a").0, 405);
    }

    #[test]
    fn the_description_names_itself_every_route_and_what_they_refer_to() {
        let (status, document) = ask("GET", "/openapi.json");
        assert_eq!(status, 200);
        let paths: Vec<_> = document["paths"].as_object().unwrap().keys().collect();
        assert_eq!(paths, ["/openapi.json", "/things/{id}"]);
        let answer =
            &document["paths"]["/things/{id}"]["get"]["responses"]["200"]["content"]["application/json"];
        assert_eq!(answer["schema"]["$ref"], "#/components/schemas/Answer");
        assert_eq!(document["components"]["schemas"]["Answer"]["required"], json!(["count"]));
        assert!(document["components"]["schemas"]["ProblemDocument"].is_object());
    }
}
