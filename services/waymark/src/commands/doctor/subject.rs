//! Which service of which vehicle is examined, from its configuration.

use std::net::SocketAddr;
use std::path::PathBuf;

use ::camera::CameraConfig;
use ::follower::FollowerConfig;
use ::leader::LeaderConfig;
use runtime::SessionSettings;
use waymark_proto::keys::{Id, VehicleKeys};

use crate::commands::config::Service;
use crate::commands::service::ConfigArgs;
use crate::exit::{Failure, OrUsage};

/// What is examined.
#[derive(Clone, Debug)]
pub(super) struct Subject {
    pub(super) service: Service,
    pub(super) keys: VehicleKeys,
    /// The vehicle whose landmarks are followed.
    pub(super) leader: Option<VehicleKeys>,
    /// Cameras whose pictures should be there.
    pub(super) cameras: Vec<Id>,
    /// Address of the page.
    pub(super) page: Option<SocketAddr>,
    pub(super) state_dir: Option<PathBuf>,
    pub(super) recordings: Option<Recordings>,
    pub(super) zenoh: SessionSettings,
}

/// Where a follower records.
#[derive(Clone, Debug)]
pub(super) struct Recordings {
    pub(super) directory: PathBuf,
    /// Free space below which recording ends.
    pub(super) min_free_bytes: u64,
    /// Cameras that are recorded together.
    pub(super) cameras: usize,
}

impl Subject {
    /// The service's configuration, which must be one.
    pub(super) fn read(service: Service, config: &ConfigArgs) -> Result<Self, Failure> {
        match service {
            Service::Leader => Self::of_leader(config.read()?),
            Service::Follower => Self::of_follower(config.read()?),
            Service::Camera => Self::of_camera(config.read()?),
        }
    }

    pub(super) fn role(&self) -> &'static str {
        match self.service {
            Service::Leader => "leader",
            Service::Follower => "follower",
            Service::Camera => "camera",
        }
    }

    fn of_leader(config: LeaderConfig) -> Result<Self, Failure> {
        config.check().or_usage()?;
        Ok(Self {
            service: Service::Leader,
            keys: VehicleKeys::new(&config.fleet, &config.vehicle).or_usage()?,
            leader: None,
            cameras: Vec::new(),
            page: Some(config.http.listen),
            state_dir: Some(config.state_dir),
            recordings: None,
            zenoh: config.zenoh,
        })
    }

    fn of_follower(config: FollowerConfig) -> Result<Self, Failure> {
        config.check().or_usage()?;
        let cameras = config.cameras.iter().map(|camera| Id::new("camera", camera));
        let cameras: Vec<Id> = cameras.collect::<Result<_, _>>().or_usage()?;
        Ok(Self {
            service: Service::Follower,
            keys: VehicleKeys::new(&config.fleet, &config.vehicle).or_usage()?,
            leader: Some(VehicleKeys::new(&config.fleet, &config.leader).or_usage()?),
            page: Some(config.http.listen),
            state_dir: Some(config.state_dir),
            recordings: config.recorder.enabled.then_some(Recordings {
                directory: config.recorder.directory,
                min_free_bytes: config.recorder.min_free_bytes,
                cameras: cameras.len(),
            }),
            cameras,
            zenoh: config.zenoh,
        })
    }

    fn of_camera(config: CameraConfig) -> Result<Self, Failure> {
        config.check().or_usage()?;
        Ok(Self {
            service: Service::Camera,
            keys: VehicleKeys::new(&config.fleet, &config.vehicle).or_usage()?,
            leader: None,
            cameras: vec![Id::new("camera", &config.camera).or_usage()?],
            page: None,
            state_dir: None,
            recordings: None,
            zenoh: config.zenoh,
        })
    }
}
