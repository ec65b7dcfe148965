"""Topics of DDS with Eclipse Cyclone DDS, for ros2.py: the few functions of libddsc.so that it takes, and the
description of a message that the library wants, made from the fields of a ctypes.Structure.
"""

import ctypes
import threading
from ctypes import POINTER, Structure, byref, c_bool, c_char_p, c_int16, c_int32, c_int64, c_size_t, c_uint32, c_uint64, c_void_p
from types import SimpleNamespace

LIBRARY, PACKAGE = "libddsc.so.0debian", "libddsc0debian"  # 0.10.2: descriptions are of this version
MOST = 16  # writers of a topic that are told apart

# dds_opcodes.h: an instruction for each field, with the place where the field is.
FIELD, END = 0x01 << 24, 0
STRING, SEQUENCE, STRUCT = 0x05, 0x07, 0x0a
NUMBERS = {1: 0x01, 2: 0x02, 4: 0x03, 8: 0x04}  # by size
XCDR1 = c_int16(0)
BEST_EFFORT, RELIABLE = 0, 1
KEEP_LAST = 0
FOREVER = (1 << 63) - 1
NOT_READ = 2 | 4 | 8 | 16 | 32 | 64


class Message(Structure):
    """A message or a part of one. Takes str for a string and any iterable for a sequence."""

    def __init__(self, **values):
        kinds = dict(self._fields_)
        super().__init__(**{name: made(kinds[name], value) for name, value in values.items()})


class Sequence(Structure):
    """A variable number of elements; sequence_of() makes the classes."""


def sequence_of(element):
    return type("SequenceOf" + element.__name__, (Sequence,), {"element": element, "_fields_": [
        ("maximum", c_uint32), ("length", c_uint32), ("buffer", POINTER(element)), ("release", c_bool)]})


def made(kind, value):
    """A Python value as the field has it."""
    if kind is c_char_p:
        return value.encode()
    if issubclass(kind, Sequence):
        values = [made(kind.element, one) for one in value]
        return kind(len(values), len(values), (kind.element * len(values))(*values))
    return value


def plain(value):
    """What was received, as Python values that do not point into the library's memory."""
    if isinstance(value, bytes):
        return value.decode(errors="replace")
    if isinstance(value, Sequence):
        return [plain(one) for one in value.buffer[:value.length]]
    if isinstance(value, Structure):
        return SimpleNamespace(**{name: plain(getattr(value, name)) for name, _ in value._fields_})
    return value


def code_of(kind):
    if kind is c_char_p:
        return STRING
    return STRUCT if issubclass(kind, Structure) else NUMBERS[ctypes.sizeof(kind)]


def instructions(message, start=0):
    """How the library reads a message from memory. Parts of a message are as if their fields stood in it."""
    ops = []
    for name, kind in message._fields_:
        place = start + getattr(message, name).offset
        if not issubclass(kind, Structure):
            ops += [FIELD | code_of(kind) << 16, place]
        elif not issubclass(kind, Sequence):
            ops += instructions(kind, place)
        else:
            ops += [FIELD | SEQUENCE << 16 | code_of(kind.element) << 8, place]
            if issubclass(kind.element, Structure):
                inner = [*instructions(kind.element), END]
                ops += [ctypes.sizeof(kind.element), (4 + len(inner)) << 16 | 4, *inner]
    return ops


class Description(Structure):
    """dds_topic_descriptor_t"""
    _fields_ = [("size", c_uint32), ("align", c_uint32), ("flags", c_uint32), ("key_count", c_uint32),
                ("name", c_char_p), ("keys", c_void_p), ("op_count", c_uint32), ("ops", POINTER(c_uint32)),
                ("meta", c_char_p), ("information", c_void_p), ("information_size", c_uint32),
                ("mapping", c_void_p), ("mapping_size", c_uint32), ("restriction", c_uint32)]


class SampleInfo(Structure):
    """dds_sample_info_t"""
    _fields_ = [("sample_state", c_uint32), ("view_state", c_uint32), ("instance_state", c_uint32),
                ("valid", c_bool), ("sent", c_int64), ("instance", c_uint64), ("writer", c_uint64),
                ("generations", c_uint32 * 5)]


def described(message, type_name):
    ops = [*instructions(message), END]
    return Description(size=ctypes.sizeof(message), align=ctypes.alignment(message), name=type_name.encode(),
                       op_count=len(ops), ops=(c_uint32 * len(ops))(*ops))


# Result and arguments; entities, sizes and results are 32 bits.
FUNCTIONS = {
    "dds_create_qos": (c_void_p,), "dds_delete_qos": (None, c_void_p),
    "dds_qset_reliability": (None, c_void_p, c_int32, c_int64),
    "dds_qset_history": (None, c_void_p, c_int32, c_int32),
    "dds_qset_data_representation": (None, c_void_p, c_uint32, POINTER(c_int16)),
    "dds_create_participant": (c_int32, c_uint32, c_void_p, c_void_p),
    "dds_create_topic": (c_int32, c_int32, POINTER(Description), c_char_p, c_void_p, c_void_p),
    "dds_create_reader": (c_int32, c_int32, c_int32, c_void_p, c_void_p),
    "dds_create_writer": (c_int32, c_int32, c_int32, c_void_p, c_void_p),
    "dds_create_waitset": (c_int32, c_int32), "dds_create_readcondition": (c_int32, c_int32, c_uint32),
    "dds_waitset_attach": (c_int32, c_int32, c_int32, c_size_t),
    "dds_waitset_wait": (c_int32, c_int32, POINTER(c_size_t), c_size_t, c_int64),
    "dds_take": (c_int32, c_int32, POINTER(c_void_p), POINTER(SampleInfo), c_size_t, c_uint32),
    "dds_return_loan": (c_int32, c_int32, POINTER(c_void_p), c_int32),
    "dds_get_matched_publications": (c_int32, c_int32, POINTER(c_uint64), c_size_t),
    "dds_write": (c_int32, c_int32, c_void_p), "dds_delete": (c_int32, c_int32), "dds_strretcode": (c_char_p, c_int32)}


def library():
    """Raises ImportError."""
    try:
        loaded = ctypes.CDLL(LIBRARY)
    except OSError as error:
        raise ImportError(str(error)) from None
    for name, (result, *arguments) in FUNCTIONS.items():
        function = getattr(loaded, name)
        function.restype, function.argtypes = result, arguments
    return loaded


class Participant:
    """In a domain, with a thread that receives. It never waits for a reader of what it sends: one that does not
    take a message gets a later one."""

    def __init__(self, domain):
        self.dds = library()
        self.entity = self.made(self.dds.dds_create_participant(domain, None, None), "domain")
        self.waits = self.made(self.dds.dds_create_waitset(self.entity), "wait set")
        self.readers, self.descriptions = [], {}
        threading.Thread(target=self.receive, daemon=True).start()

    def made(self, entity, what):
        if entity < 0:
            raise ConnectionError(f"DDS: {what}: {self.dds.dds_strretcode(-entity).decode()}")
        return entity

    def endpoint(self, create, topic, message, type_name, reliability):
        """The newest message only, in the encoding of ROS."""
        dds, description = self.dds, described(message, type_name)
        self.descriptions[topic] = description
        qos = dds.dds_create_qos()
        dds.dds_qset_reliability(qos, reliability, 0)
        dds.dds_qset_history(qos, KEEP_LAST, 1)
        dds.dds_qset_data_representation(qos, 1, byref(XCDR1))
        entity = self.made(dds.dds_create_topic(self.entity, byref(description), topic.encode(), None, None), topic)
        entity = self.made(create(self.entity, entity, qos, None), topic)
        dds.dds_delete_qos(qos)
        return entity

    def writer(self, topic, message, type_name):
        """Reliable, so that every reader takes it."""
        return Writer(self.dds, self.endpoint(self.dds.dds_create_writer, topic, message, type_name, RELIABLE))

    def reader(self, topic, message, type_name, take, reliability=BEST_EFFORT):
        """take(message, writer) is called for each. With BEST_EFFORT every writer fits."""
        entity = self.endpoint(self.dds.dds_create_reader, topic, message, type_name, reliability)
        self.readers.append(Reader(self.dds, entity, message, take))
        condition = self.made(self.dds.dds_create_readcondition(entity, NOT_READ), topic)
        self.made(self.dds.dds_waitset_attach(self.waits, condition, len(self.readers) - 1), topic)
        return self.readers[-1]

    def receive(self):
        ready = (c_size_t * MOST)()
        while (count := self.dds.dds_waitset_wait(self.waits, ready, MOST, FOREVER)) >= 0:
            for which in ready[:min(count, MOST)]:
                self.readers[which].receive()

    def close(self):
        """Tells the others."""
        self.dds.dds_delete(self.entity)


class Writer:
    def __init__(self, dds, entity):
        self.dds, self.entity = dds, entity

    def publish(self, message):
        self.dds.dds_write(self.entity, byref(message))


class Reader:
    def __init__(self, dds, entity, message, take):
        self.dds, self.entity, self.message, self.take = dds, entity, message, take

    def writers(self):
        """A handle for each writer that is there."""
        handles = (c_uint64 * MOST)()
        return handles[:max(0, min(MOST, self.dds.dds_get_matched_publications(self.entity, handles, MOST)))]

    def receive(self):
        loan, info = c_void_p(), SampleInfo()
        while self.dds.dds_take(self.entity, byref(loan), byref(info), 1, 1) == 1:
            message = plain(self.message.from_address(loan.value)) if info.valid else None
            self.dds.dds_return_loan(self.entity, byref(loan), 1)
            if message:
                self.take(message, info.writer)
            loan = c_void_p()
