"""Machine code: made by LLVM, kept on disk, loaded into this process."""

from __future__ import annotations

import atexit
import os
import platform
import sys
from contextlib import suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from threading import Lock
from typing import Any

_DIGEST = sha256().digest_size

FOLDER = "IRC_CACHE_DIR"
"""The environment variable with the folder in which machine code is kept."""


AT_WORK = Lock()
"""Held while LLVM works. It does not survive the end of the process, which waits for its step."""


@atexit.register
def _wait() -> None:
    """Waits for the step at which LLVM is, and lets no other one begin."""
    AT_WORK.acquire()


def machine() -> str:
    """The name of all that machine code depends on, except for the program."""
    import llvmlite
    from llvmlite import binding

    features = binding.get_host_cpu_features().flatten()
    return " ".join([llvmlite.__version__, binding.get_host_cpu_name(), features])


def optimised(text: str) -> bytes:
    """A module in LLVM's language as bitcode of this machine, which takes most of the time."""
    from llvmlite import binding

    module, target = binding.parse_assembly(text), _target()
    module.triple, module.data_layout = target.triple, str(target.target_data)
    options = binding.create_pipeline_tuning_options(speed_level=3)
    options.slp_vectorization = False
    passes = binding.create_pass_builder(target, options)
    passes.getModulePassManager().run(module, passes)
    return bytes(module.as_bitcode())


def machine_code(bitcode: bytes) -> bytes:
    """Bitcode as machine code, which takes the rest of it."""
    from llvmlite import binding

    target = _target()  # (This makes LLVM ready, too.)
    return bytes(target.emit_object(binding.parse_bitcode(bitcode)))


def loaded(code: bytes) -> Any:
    """Machine code in this process; `get_function_address` gives that of a function."""
    from llvmlite import binding

    engine = binding.create_mcjit_compiler(binding.parse_assembly(""), _target())
    engine.add_object_file(binding.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine


def _target() -> Any:
    """A description of this machine."""
    from llvmlite import binding

    _initialize()
    is_x86 = platform.machine().lower() in ("x86_64", "amd64", "i386", "i686", "x86")
    return binding.Target.from_triple(binding.get_process_triple()).create_target_machine(
        cpu=binding.get_host_cpu_name(),
        features=binding.get_host_cpu_features().flatten(),
        opt=3,
        reloc="static" if is_x86 else "default",
        codemodel="jitdefault",
        jit=True,
    )


@cache
def _initialize() -> None:
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()


def folder() -> Path:
    """The folder in which machine code is kept: that of `IRC_CACHE_DIR`, or the user's."""
    if given := os.environ.get(FOLDER):
        return Path(given)
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA", "~/AppData/Local")
    elif sys.platform == "darwin":
        base = "~/Library/Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME", "~/.cache")
    return Path(base).expanduser() / "irc-compiler"


def kept(name: str) -> bytes | None:
    """The code that is kept under a name; None: there is none, or it is damaged."""
    with suppress(OSError, RuntimeError):  # (There may be no home.)
        content = (folder() / name).read_bytes()
        code = content[_DIGEST:]
        if sha256(code).digest() == content[:_DIGEST]:
            return code
    return None


def keep(name: str, code: bytes) -> None:
    """Keeps code under a name; where that is not possible, nothing is kept."""
    with suppress(OSError, RuntimeError):
        folder().mkdir(parents=True, exist_ok=True)
        part = folder() / f"{name}.{os.getpid()}"
        part.write_bytes(sha256(code).digest() + code)
        part.replace(folder() / name)


def forget(name: str) -> None:
    """Removes what is kept under a name."""
    with suppress(OSError, RuntimeError):
        (folder() / name).unlink()
