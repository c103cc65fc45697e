//! `waymark config show`.

use ::camera::CameraConfig;
use ::follower::FollowerConfig;
use ::leader::LeaderConfig;
use runtime::config::{Layers, Setting};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::Service;
use crate::columns::Columns;
use crate::commands::service::ConfigArgs;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Show every setting with its value and where that comes from
///
/// Reads the same layers as the service: defaults, then files in their order, then WAYMARK__… variables, then --set;
/// the last one that says something wins. Settings that nothing sets and that have no default are not listed.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Whose configuration
    service: Service,

    #[command(flatten)]
    config: ConfigArgs,

    /// Print a JSON array of key, value and source
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    match args.service {
        Service::Leader => show::<LeaderConfig>(args),
        Service::Follower => show::<FollowerConfig>(args),
        Service::Camera => show::<CameraConfig>(args),
    }
}

/// Shows what there is, also where the service would refuse it, and then says why it would.
fn show<C: Serialize + DeserializeOwned + Default>(args: &Args) -> Result<Ending, Failure> {
    let layers: Layers = args.config.layers::<C>()?;
    let settings = layers.settings().or_usage()?;
    let text = if args.json { format!("{:#}\n", serde_json::json!(settings)) } else { listed(&settings) };
    Console::write_results(text.as_bytes())?;
    layers.extract::<C>().or_usage()?;
    Ok(Ending::Fine)
}

fn listed(settings: &[Setting]) -> String {
    let mut table = Columns::new(["setting", "value", "from"]);
    for Setting { key, value, source } in settings {
        table.row([key.clone(), value.clone(), source.clone()]);
    }
    table.text()
}
