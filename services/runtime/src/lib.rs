//! What every service needs: configuration layers, telemetry, shutdown, the Zenoh session.
