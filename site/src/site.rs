//! Which request goes to which demonstration, and what they keep from one to the next.

use crate::SiteError;
use crate::cover;
use crate::model::Model;
use crate::probes::Probes;
use crate::reply::Reply;
use crate::request::Request;
use crate::scans::Scans;
use crate::surfels::Surfels;

/// The demonstrations, with the models and the light that they hold.
#[derive(Default)]
pub struct Site {
    model: Option<Model>,
    surfels: Option<Surfels>,
    scans: Option<Scans>,
    probes: Option<Probes>,
}

impl Site {
    /// With nothing in it yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Answers a request; one that cannot be answered with the fact `error`.
    pub fn answer(&mut self, request: &[u8]) -> Reply {
        self.try_answer(&mut Request::new(request)).unwrap_or_else(|error| Reply::of_error(&error))
    }

    fn try_answer(&mut self, request: &mut Request<'_>) -> Result<Reply, SiteError> {
        match request.word() {
            "polygon" => cover::answer(request),
            "model" => {
                let model = Model::read(request)?;
                let reply = model.describe();
                self.model = Some(model);
                Ok(reply)
            }
            "surfels" => {
                let surfels = Surfels::new(self.model()?, request)?;
                let reply = surfels.describe();
                self.surfels = Some(surfels);
                Ok(reply)
            }
            "surfels-frame" => self.surfels.as_mut().ok_or(SiteError::TooEarly("surfels"))?.draw(request),
            "surfels-depth" => self.surfels.as_ref().ok_or(SiteError::TooEarly("surfels"))?.depth(request),
            "scans" => {
                let scans = Scans::new(self.model()?, request)?;
                let reply = scans.describe();
                self.scans = Some(scans);
                Ok(reply)
            }
            "scans-frame" => self.scans.as_mut().ok_or(SiteError::TooEarly("scans"))?.draw(request),
            "rooms" => {
                let probes = Probes::new()?;
                let reply = probes.describe(request)?;
                self.probes = Some(probes);
                Ok(reply)
            }
            "ball" => self.probes.as_ref().ok_or(SiteError::TooEarly("rooms"))?.ball(request),
            other => Err(SiteError::Unknown(other.to_string())),
        }
    }

    fn model(&self) -> Result<&Model, SiteError> {
        self.model.as_ref().ok_or(SiteError::TooEarly("model"))
    }
}
