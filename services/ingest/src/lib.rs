//! Where frames come from: source URIs, decoders, the newest-wins mailbox, and the thread that drives vision::Follow.
