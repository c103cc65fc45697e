"""Reading recordings, and the table of the thesis from one."""

from pathlib import Path

import pytest
from examples import make_landmark, make_registration
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import Message
from mcap.writer import Writer

from waymark import appendix_b, recording
from waymark.v1 import Miss, Registration


def write(path: Path, messages: list[tuple[str, Message]]) -> Path:
    with open(path, "wb") as file:
        writer = Writer(file)
        writer.start(profile="", library="test")
        channels: dict[str, int] = {}
        for number, (topic, message) in enumerate(messages):
            if topic not in channels:
                descriptors = FileDescriptorSet()
                message.DESCRIPTOR.file.CopyToProto(descriptors.file.add())
                schema = writer.register_schema(
                    message.DESCRIPTOR.full_name, "protobuf", descriptors.SerializeToString()
                )
                channels[topic] = writer.register_channel(topic, "protobuf", schema)
            writer.add_message(
                channels[topic], log_time=number, publish_time=number, sequence=number, data=message.SerializeToString()
            )
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def missed() -> Registration:
    registration = Registration(camera="front", sequence=2)
    registration.landmarks.add(landmark="red", miss=Miss(reason=Miss.REASON_NO_COLOUR))
    return registration


def test_messages_are_read_by_their_type(tmp_path: Path) -> None:
    path = write(
        tmp_path / "drive.mcap",
        [("/leader/landmark", make_landmark("red")), ("/follower/camera/front/registration", make_registration(7))],
    )
    assert [entry.message.id for entry in recording.landmarks(path)] == ["red"]
    entries = list(recording.registrations(path))
    assert [(entry.topic, entry.sequence) for entry in entries] == [("/follower/camera/front/registration", 1)]
    assert entries[0].message == make_registration(7)
    assert list(recording.truth(path)) == []


def test_appendix_b_has_a_line_for_each_frame_and_reasons_instead_of_zeros() -> None:
    lines = list(appendix_b.rows([missed(), make_registration(3), make_registration(4, "blue")], "red"))
    assert lines == [
        "Frame= 1\tmissed: no colour",
        "Frame= 2\tX_pos= 441.94\tY_pos= 322.30\tArea= 203.50",
        "Frame= 3\tnot looked for",
    ]


def test_appendix_b_asks_for_the_camera_when_there_are_several(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    other = make_registration(1)
    other.camera = "rear"
    path = write(tmp_path / "drive.mcap", [("/a", make_registration(1)), ("/b", other)])
    monkeypatch.setattr("sys.argv", ["waymark-appendix-b", str(path)])
    with pytest.raises(SystemExit):
        appendix_b.main()
    assert "front, rear" in capsys.readouterr().err
