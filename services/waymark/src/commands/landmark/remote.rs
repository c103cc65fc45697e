//! `waymark landmark list|publish|retire|pull|push`: what is said to a running leader.

use std::path::PathBuf;

use anyhow::Context;
use leader::client::LandmarkClient;
use leader::landmark_files::{read_landmarks, write_landmarks};
use leader::{Edit, Others};
use runtime::SessionSettings;
use vision::LandmarkSet;
use waymark_proto::documents::SetDocument;
use waymark_proto::keys::VehicleKeys;

use crate::columns::Columns;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Which leader is meant, and the way to it.
#[derive(Debug, clap::Args)]
pub(crate) struct Reach {
    /// Router to connect to
    #[arg(long, value_name = "ENDPOINT", default_value = "tcp/127.0.0.1:7447")]
    router: String,

    /// Zenoh configuration (JSON5) to be used as it is, for TLS and users
    #[arg(long, value_name = "FILE", conflicts_with = "router")]
    zenoh: Option<PathBuf>,

    /// Fleet
    #[arg(long, value_name = "ID", default_value = "convoy")]
    fleet: String,

    /// Vehicle whose landmarks are meant
    #[arg(long, value_name = "ID", default_value = "leader")]
    vehicle: String,
}

/// List the landmarks that a leader publishes
///
/// A router with a store answers for a leader that is gone.
#[derive(Debug, clap::Args)]
pub(crate) struct List {
    #[command(flatten)]
    reach: Reach,

    /// Print the set as JSON
    #[arg(long)]
    json: bool,
}

/// Add landmarks to a running leader's set, or put them in the place of those with the same id
#[derive(Debug, clap::Args)]
pub(crate) struct Publish {
    /// Landmark files, or directories of them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    #[command(flatten)]
    reach: Reach,
}

/// Take landmarks out of a running leader's set
#[derive(Debug, clap::Args)]
pub(crate) struct Retire {
    /// Landmarks
    #[arg(required = true, value_name = "ID")]
    ids: Vec<String>,

    #[command(flatten)]
    reach: Reach,
}

/// Write a leader's landmarks to a directory, one file each
#[derive(Debug, clap::Args)]
pub(crate) struct Pull {
    /// Directory; made when it does not exist
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    #[command(flatten)]
    reach: Reach,
}

/// Make a running leader's set what a directory holds: what the directory lacks is retired
#[derive(Debug, clap::Args)]
pub(crate) struct Push {
    /// Directory of landmark files
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    #[command(flatten)]
    reach: Reach,
}

pub(crate) fn list(args: &List) -> Result<Ending, Failure> {
    let set = args.reach.speak(async |leader| Ok(leader.list().await?))?;
    let text = match args.json {
        true => {
            serde_json::to_string_pretty(&SetDocument::from(&set)).context("cannot write the set as JSON")?
                + "\n"
        }
        false => listed(&set),
    };
    Console::write_results(text.as_bytes())?;
    Ok(Ending::Fine)
}

pub(crate) fn publish(args: &Publish, console: Console) -> Result<Ending, Failure> {
    let publish = read_landmarks(&args.files).or_usage()?;
    args.reach.edit(&Edit { publish, ..Edit::default() }, console)
}

pub(crate) fn retire(args: &Retire, console: Console) -> Result<Ending, Failure> {
    args.reach.edit(&Edit { retire: args.ids.clone(), ..Edit::default() }, console)
}

pub(crate) fn push(args: &Push, console: Console) -> Result<Ending, Failure> {
    let publish = read_landmarks(std::slice::from_ref(&args.directory)).or_usage()?;
    args.reach.edit(&Edit { publish, others: Others::Retire, ..Edit::default() }, console)
}

pub(crate) fn pull(args: &Pull, console: Console) -> Result<Ending, Failure> {
    let set = args.reach.speak(async |leader| Ok(leader.list().await?))?;
    let written = write_landmarks(&args.directory, &set).context("cannot write the landmarks")?;
    console.note(&format!("{} landmarks written to {}", written.len(), args.directory.display()));
    Ok(Ending::Fine)
}

impl Reach {
    fn edit(&self, edit: &Edit, console: Console) -> Result<Ending, Failure> {
        let manifest = self.speak(async |leader| Ok(leader.edit(edit).await?))?;
        let (epoch, version) = (manifest.version.epoch, manifest.version.version);
        console.note(&format!("the set has {} landmarks now, version {epoch}.{version}", manifest.count));
        Ok(Ending::Fine)
    }

    fn speak<T>(&self, words: impl AsyncFnOnce(LandmarkClient) -> anyhow::Result<T>) -> Result<T, Failure> {
        let keys = VehicleKeys::new(&self.fleet, &self.vehicle).or_usage()?;
        let settings = SessionSettings { file: self.zenoh.clone(), ..SessionSettings::client(&self.router) };
        // Zenoh needs worker threads of its own runtime, and one to wait on.
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?;
        runtime.block_on(async {
            let session = settings.open().await.map_err(anyhow::Error::from)?;
            let said = words(LandmarkClient::new(session.clone(), keys)).await;
            // What was said was answered; a session that does not close costs nothing more.
            let _ = session.close().await;
            Ok(said?)
        })
    }
}

fn listed(set: &LandmarkSet) -> String {
    let mut table = Columns::new(["landmark", "revision", "shape", "window", "shades", "digest"]);
    for landmark in &set.landmarks {
        let window = format!("{}×{}", landmark.window_px.width, landmark.window_px.height);
        let digest = landmark.digest.to_string().chars().take(12).collect();
        let (revision, shades) = (landmark.revision.to_string(), landmark.shades.len().to_string());
        table.row([landmark.id.clone(), revision, landmark.shape.name().to_owned(), window, shades, digest]);
    }
    table.text()
}
