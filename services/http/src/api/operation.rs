//! What is said of one method at one path.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};
use std::ops::RangeInclusive;

/// One method at one path: parameters, body, answers.
pub struct Operation {
    method: &'static str,
    summary: &'static str,
    parameters: Vec<Value>,
    query: Vec<&'static str>,
    body: Option<Value>,
    answers: Vec<(u16, Content)>,
    problems: Vec<(u16, &'static str)>,
}

type SchemaOf = Box<dyn FnOnce(&mut SchemaGenerator) -> Value>;

enum Content {
    Json(SchemaOf),
    Other(&'static str, Value),
    Empty,
}

impl Operation {
    fn new(method: &'static str, summary: &'static str) -> Self {
        let (parameters, query, answers, problems) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { method, summary, parameters, query, body: None, answers, problems }
    }

    /// Reads something.
    #[must_use]
    pub fn get(summary: &'static str) -> Self {
        Self::new("get", summary)
    }

    /// Does something.
    #[must_use]
    pub fn post(summary: &'static str) -> Self {
        Self::new("post", summary).guarded()
    }

    /// Puts something in a place.
    #[must_use]
    pub fn put(summary: &'static str) -> Self {
        Self::new("put", summary).guarded()
    }

    /// Takes something away.
    #[must_use]
    pub fn delete(summary: &'static str) -> Self {
        Self::new("delete", summary).guarded()
    }

    fn guarded(self) -> Self {
        self.problem(401, "The token is missing or another")
            .problem(403, "Read-only, or asked from another site")
    }

    /// A part of the path that varies; `schema` as in OpenAPI.
    #[must_use]
    pub fn path(mut self, name: &'static str, description: &'static str, schema: Value) -> Self {
        let mut parameter =
            json!({ "name": name, "in": "path", "required": true, "description": description });
        parameter["schema"] = schema;
        self.parameters.push(parameter);
        self
    }

    /// A query parameter; `schema` as in OpenAPI.
    #[must_use]
    pub fn query(mut self, name: &'static str, description: &'static str, schema: Value) -> Self {
        let mut parameter = json!({ "name": name, "in": "query", "description": description });
        parameter["schema"] = schema;
        self.parameters.push(parameter);
        self.query.push(name);
        self
    }

    /// A query parameter that takes some of these names, with commas between them.
    #[must_use]
    pub fn list(mut self, name: &'static str, description: &'static str, names: &[&str]) -> Self {
        let schema = json!({ "type": "array", "items": { "type": "string", "enum": names } });
        self = self.query(name, description, schema);
        if let Some(parameter) = self.parameters.last_mut() {
            parameter["style"] = json!("form");
            parameter["explode"] = json!(false);
        }
        self
    }

    /// A query parameter that must be there.
    #[must_use]
    pub fn required(mut self, name: &'static str, description: &'static str, schema: Value) -> Self {
        self = self.query(name, description, schema);
        if let Some(parameter) = self.parameters.last_mut() {
            parameter["required"] = json!(true);
        }
        self
    }

    /// What is sent along, as JSON.
    #[must_use]
    pub fn takes<T: JsonSchema>(mut self) -> Self {
        self.body = Some(taken::<T>());
        self.problem(413, "The body is too large")
            .problem(415, "The body is not announced as JSON")
            .problem(422, "The body's fields are not what is expected")
    }

    /// Answers 200 with a JSON document.
    #[must_use]
    pub fn gives<T: JsonSchema>(self) -> Self {
        self.gives_with::<T>(200)
    }

    /// Answers with a JSON document and this status.
    #[must_use]
    pub fn gives_with<T: JsonSchema>(mut self, status: u16) -> Self {
        self.answers.push((status, Content::Json(schema_of::<T>())));
        self
    }

    /// Answers 200 with something else than a document of ours.
    #[must_use]
    pub fn answers(mut self, media_type: &'static str, schema: Value) -> Self {
        self.answers.push((200, Content::Other(media_type, schema)));
        self
    }

    /// Answers 200 with bytes.
    #[must_use]
    pub fn binary(self, media_type: &'static str) -> Self {
        self.answers(media_type, json!({}))
    }

    /// Answers 206 with a part of it.
    #[must_use]
    pub fn partial(mut self, media_type: &'static str) -> Self {
        self.answers.push((206, Content::Other(media_type, json!({}))));
        self
    }

    /// Answers with this status and nothing else.
    #[must_use]
    pub fn empty(mut self, status: u16) -> Self {
        self.answers.push((status, Content::Empty));
        self
    }

    /// May answer with a problem of this status.
    #[must_use]
    pub fn problem(mut self, status: u16, when: &'static str) -> Self {
        self.problems.push((status, when));
        self
    }

    pub(super) fn method(&self) -> &'static str {
        self.method
    }

    pub(super) fn query_names(&self) -> Vec<&'static str> {
        self.query.clone()
    }

    /// The operation object of OpenAPI 3.1.
    pub(super) fn described(self, path: &str, schemas: &mut SchemaGenerator) -> Value {
        let is_change = self.method != "get";
        let mut document = Map::new();
        document.insert("summary".to_owned(), json!(self.summary));
        document.insert("operationId".to_owned(), json!(operation_id(self.method, path)));
        document.insert("parameters".to_owned(), json!(self.parameters));
        if let Some(body) = self.body {
            let content = json!({ "application/json": { "schema": body } });
            document.insert("requestBody".to_owned(), json!({ "required": true, "content": content }));
        }
        if is_change {
            // Where no token is set none is needed.
            document.insert("security".to_owned(), json!([{}, { "token": [] }]));
        }
        document.insert("responses".to_owned(), responses(self.answers, self.problems, schemas));
        Value::Object(document)
    }
}

/// The schema of a whole number within limits.
#[must_use]
pub fn integer<N: Into<u64> + Copy>(allowed: &RangeInclusive<N>) -> Value {
    let (least, most): (u64, u64) = ((*allowed.start()).into(), (*allowed.end()).into());
    json!({ "type": "integer", "minimum": least, "maximum": most })
}

/// What is read differs from what is written: members with defaults may be left out.
fn taken<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().for_deserialize().with(|settings| {
        settings.inline_subschemas = true;
        settings.meta_schema = None;
    });
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

fn schema_of<T: JsonSchema>() -> SchemaOf {
    Box::new(|schemas| schemas.subschema_for::<T>().to_value())
}

fn responses(
    answers: Vec<(u16, Content)>,
    problems: Vec<(u16, &'static str)>,
    schemas: &mut SchemaGenerator,
) -> Value {
    let mut responses = Map::new();
    for (status, content) in answers {
        let response =
            responses.entry(status.to_string()).or_insert_with(|| json!({ "description": "As asked" }));
        let (media_type, schema) = match content {
            Content::Json(schema) => ("application/json", schema(schemas)),
            Content::Other(media_type, schema) => (media_type, schema),
            Content::Empty => continue,
        };
        response["content"][media_type] = json!({ "schema": schema });
    }
    for (status, when) in problems {
        let mut problem = json!({ "$ref": "#/components/responses/Problem" });
        problem["description"] = json!(when);
        responses.insert(status.to_string(), problem);
    }
    responses.insert("default".to_owned(), json!({ "$ref": "#/components/responses/Problem" }));
    Value::Object(responses)
}

/// `get_api_v1_cameras_camera_frame_jpg`.
fn operation_id(method: &str, path: &str) -> String {
    let words = path.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    std::iter::once(method).chain(words).collect::<Vec<_>>().join("_")
}
