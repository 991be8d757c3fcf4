# SPDX-License-Identifier: GPL-3.0-or-later
"""clap_host.py PLUGIN.clap: the least of a CLAP host, by the C interface itself: loads the plugin, activates it and
lets sound through."""
import ctypes as c
import math
import sys

u32, pointer, text = c.c_uint32, c.c_void_p, c.c_char_p


def struct(name, *fields):
    return type(name, (c.Structure,), {"_fields_": list(fields)})


def call(result, *arguments):
    return c.CFUNCTYPE(result, *arguments)


Version = struct("Version", ("major", u32), ("minor", u32), ("revision", u32))
Entry = struct("Entry", ("version", Version), ("init", call(c.c_bool, text)), ("deinit", call(None)),
               ("factory", call(pointer, text)))
Descriptor = struct("Descriptor", ("version", Version), ("id", text), ("name", text), ("vendor", text))
Factory = struct("Factory", ("count", call(u32, pointer)), ("descriptor", call(c.POINTER(Descriptor), pointer, u32)),
                 ("create", call(pointer, pointer, pointer, text)))
Host = struct("Host", ("version", Version), ("data", pointer), ("name", text), ("vendor", text), ("url", text),
              ("ours", text), ("extension", call(pointer, pointer, text)), ("restart", call(None, pointer)),
              ("process", call(None, pointer)), ("callback", call(None, pointer)))
Buffer = struct("Buffer", ("data32", c.POINTER(c.POINTER(c.c_float))), ("data64", pointer), ("channels", u32),
                ("latency", u32), ("constant", c.c_uint64))
Inputs = struct("Inputs", ("context", pointer), ("size", call(u32, pointer)), ("get", call(pointer, pointer, u32)))
Outputs = struct("Outputs", ("context", pointer), ("push", call(c.c_bool, pointer, pointer)))
Process = struct("Process", ("time", c.c_int64), ("frames", u32), ("transport", pointer), ("inputs", c.POINTER(Buffer)),
                 ("outputs", c.POINTER(Buffer)), ("input_count", u32), ("output_count", u32),
                 ("events", c.POINTER(Inputs)), ("answers", c.POINTER(Outputs)))
Plugin = struct("Plugin", ("descriptor", c.POINTER(Descriptor)), ("data", pointer), ("init", call(c.c_bool, pointer)),
                ("destroy", call(None, pointer)), ("activate", call(c.c_bool, pointer, c.c_double, u32, u32)),
                ("deactivate", call(None, pointer)), ("start", call(c.c_bool, pointer)), ("stop", call(None, pointer)),
                ("reset", call(None, pointer)), ("run", call(c.c_int32, pointer, c.POINTER(Process))))

path = sys.argv[1]
entry = Entry.in_dll(c.CDLL(path), "clap_entry")
assert entry.init(path.encode())
factory_at = entry.factory(b"clap.plugin-factory")
factory = Factory.from_address(factory_at)
assert factory.count(factory_at) == 1
described = factory.descriptor(factory_at, 0).contents
assert described.name == b"Excursion", described.name
nothing = call(None, pointer)(lambda host: None)
host = Host(Version(1, 1, 0), None, b"test", b"test", b"", b"1", Host._fields_[6][1](lambda host, name: None),
            nothing, nothing, nothing)
plugin_at = factory.create(factory_at, c.addressof(host), described.id)
plugin = Plugin.from_address(plugin_at)
frames, channels, rate = 256, 2, 48000.0
assert plugin.init(plugin_at) and plugin.activate(plugin_at, rate, 1, frames) and plugin.start(plugin_at)


def buffer():
    blocks = [(c.c_float * frames)() for _ in range(channels)]
    pointers = (c.POINTER(c.c_float) * channels)(*(c.cast(block, c.POINTER(c.c_float)) for block in blocks))
    return blocks, pointers, Buffer(pointers, None, channels, 0, 0)


played, p, given = buffer()
heard, q, got = buffer()
events = Inputs(None, Inputs._fields_[1][1](lambda events: 0), Inputs._fields_[2][1](lambda events, k: None))
answers = Outputs(None, Outputs._fields_[1][1](lambda events, event: True))
peak = 0.0
for block in range(100):
    for k in range(frames):
        for channel in played:
            channel[k] = 0.1 * math.sin(2 * math.pi * 100 * (block * frames + k) / rate)
    process = Process(block * frames, frames, None, c.pointer(given), c.pointer(got), 1, 1, c.pointer(events),
                      c.pointer(answers))
    assert plugin.run(plugin_at, c.byref(process)) != 0
    samples = [value for channel in heard for value in channel]
    assert all(math.isfinite(value) for value in samples)
    peak = max(peak, *map(abs, samples))
assert 0.01 < peak < 1.0, peak
plugin.stop(plugin_at)
plugin.deactivate(plugin_at)
plugin.destroy(plugin_at)
entry.deinit()
print(f"CLAP: {described.name.decode()} of {described.vendor.decode()} plays, peak {peak:.3f}")
