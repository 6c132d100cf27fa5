"""Memory and threads: views, buffers, lifetimes, the interpreter's lock, the log."""

import ctypes
import gc
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
import warnings
import weakref
from pathlib import Path

import anthronet
import numpy as np
import pytest
from anthronet import _library, _native
from support import ROOT, raises

ARRAYS = ("positions", "normals", "uvs", "triangles", "joints", "weights", "sources", "quads", "quad_uvs", "triangle_uvs")
CONFLICT = {"height": 1.9, "torso_height_back": 0.35, "thigh_length": 0.32, "neck_length_midline": 0.06}


def test_views(woman):
    """views are the library's memory: not copied, read-only for good"""
    part = woman.mesh(lod=1)[0]
    for name in ARRAYS:
        view = getattr(part, name)
        assert not view.flags.writeable and not view.flags.owndata or len(view) == 0, name
        if len(view):
            assert np.shares_memory(view, getattr(part, name)), name
            raises(ValueError, lambda: setattr(view.flags, "writeable", True))
            raises(ValueError, lambda: view.__setitem__(0, 0))
    copy = part.read("positions")
    assert copy.flags.writeable and not np.shares_memory(copy, part.positions)


@pytest.mark.parametrize("layout", ["render", "model"])
def test_reading(woman, layout):
    """arrays are read into buffers of any stride, and nothing beside them is written"""
    part = woman.mesh(lod=1, layout=layout)[0]
    for name in ARRAYS:
        view = getattr(part, name)
        fresh = part.read(name)
        assert np.array_equal(fresh, view) and fresh.dtype == view.dtype, name
        if view.ndim == 1:
            wide = np.full(3 * len(view), 7, view.dtype)
            assert part.read(name, wide[1::3]) is not None and np.array_equal(wide[1::3], view)
            assert (wide[0::3] == 7).all() and (wide[2::3] == 7).all()
            back = np.zeros_like(view)[::-1]
            assert np.array_equal(part.read(name, back), view)
            continue
        count, columns = view.shape
        wide = np.full((count, columns + 3), 7, view.dtype)
        part.read(name, wide[:, 1 : 1 + columns])
        assert np.array_equal(wide[:, 1 : 1 + columns], view) and (wide[:, 0] == 7).all() and (wide[:, -1] == 7).all()
        for odd in (np.zeros((columns, count), view.dtype).T, np.zeros((count, columns), view.dtype)[::-1],
                    np.zeros((count, 2 * columns), view.dtype)[:, ::2], np.zeros((2 * count, columns), view.dtype)[::2]):
            assert np.array_equal(part.read(name, odd), view), (name, odd.strides)
        record = np.zeros(count, np.dtype({"names": ["a"], "formats": [(view.dtype, (columns,))], "offsets": [5],
                                           "itemsize": 5 + view.itemsize * columns + 2}))
        assert np.array_equal(part.read(name, record["a"]), view), "rows that are not aligned"


def test_reading_refusals(woman):
    """buffers that an array does not fit into are refused"""
    part = woman.mesh(lod=3)[0]
    shape = part.positions.shape
    for wrong, kind in ((np.zeros(shape), TypeError), (np.zeros(shape, "i4"), TypeError), (np.zeros(shape, ">f4"), TypeError),
                        ([], TypeError), (np.zeros((shape[0] - 1, 3), "f4"), ValueError), (np.zeros(3, "f4"), ValueError),
                        (part.normals, ValueError)):
        raises(kind, lambda: part.read("positions", wrong), "out")
    raises(ValueError, lambda: part.read("colours"), "attribute", "colours")
    raises(TypeError, lambda: part.read(["positions"]), "attribute")


def test_views_keep_memory(woman, man):
    """views live on without mesh, part and body, and through updates"""
    mesh = woman.mesh(lod=1)
    view, before = mesh[0].positions, mesh[0].read("positions")
    handle = weakref.ref(mesh._handle)
    mesh.update(man)
    assert np.array_equal(view, before), "the surface of before"
    assert np.array_equal(mesh[0].positions, man.mesh(lod=1)[0].positions) and not np.array_equal(mesh[0].positions, before)
    mesh.close()
    del mesh
    gc.collect()
    for _ in range(20):
        woman.mesh(lod=1)  # What was freed by mistake would be overwritten.
    assert handle() is not None and np.array_equal(view, before)
    part_of_it = view[10:20]
    del view
    assert handle() is not None and np.array_equal(part_of_it, before[10:20])
    del part_of_it
    gc.collect()
    assert handle() is None, "the last view frees the memory"


def test_freeing(model):
    """every handle is freed once: by close, the end of with, the last reference"""
    gc.collect()  # What other tests left.
    freed = []
    names = [name for name in _native.FUNCTIONS if name.endswith("_free")]
    plain = {name: getattr(_library.lib, name) for name in names}

    def counting(name):
        def free(pointer):
            freed.append((name, pointer))
            plain[name](pointer)

        return free

    try:
        for name in names:
            setattr(_library.lib, name, counting(name))
        request = anthronet.Request(height=1.7)
        request["height"] = 1.71
        body = model.generate(request)
        mesh, clip = body.mesh(lod=3), anthronet.builtin_clip("idle", body)
        skinner, job = mesh.skinner(), model.start([request])
        body.report
        live = [mesh._handle.value, clip._handle.value, skinner._handle.value, job._handle.value, body._handle.value]
        body.close()
        with skinner, clip:
            pass
        assert {"body", "skinner", "clip"} <= {name.split("_")[1] for name, _ in freed}
        del request, body, mesh, clip, skinner, job
        gc.collect()
        for pointer in live:
            assert sum(pointer == other for _, other in freed) >= 1, freed
        kinds = [name for name, _ in freed]
        for name, count in (("anthronet_request_free", 2), ("anthronet_body_free", 1), ("anthronet_mesh_free", 1),
                            ("anthronet_clip_free", 1), ("anthronet_skinner_free", 1), ("anthronet_job_free", 1)):
            assert kinds.count(name) == count, (name, kinds)
        try:
            model.generate(anthronet.Request(height=17))
        except anthronet.RequestError:
            pass
        gc.collect()
        assert [name for name, _ in freed].count("anthronet_body_free") == 1, "what failed is not freed"
    finally:
        for name in names:
            setattr(_library.lib, name, plain[name])


def test_closed(woman, model):
    """what is closed says so, and closing twice does nothing"""
    body = model.generate(anthronet.Request("male"))
    mesh, clip = body.mesh(lod=3), anthronet.builtin_clip("walk", body)
    part, skinner = mesh[0], mesh.skinner()
    for thing in (body, mesh, clip, skinner):
        thing.close()
        thing.close()
        assert thing.closed and "closed" in f"{thing!r} closed"
    for use in (lambda: body.report, lambda: body.mesh(), lambda: body.joints(), lambda: body.to_bytes("glb"),
                lambda: part.positions, lambda: part.read("normals"), lambda: mesh.update(woman), lambda: mesh.skinner(),
                lambda: mesh.blend_shapes, lambda: clip.sample(0), lambda: clip.bake(), lambda: woman.to_bytes("glb", clips=[clip]),
                lambda: skinner.skin(np.zeros((body.joint_count, 7))), lambda: anthronet.builtin_clip("walk", body),
                lambda: body.__enter__()):
        raises(ValueError, use, "closed")
    assert body.sex == "male" and body.mass_kg > 0, "numbers stay"


def test_closing_under_a_call(woman, model):
    """closing a model, body or mesh that others are using harms nobody"""
    errors, stop = [], threading.Event()

    def work(make, use):
        while not stop.is_set():
            thing = make()
            thread = threading.Thread(target=attempt, args=(use, thing))
            thread.start()
            thing.close()
            thread.join()

    def attempt(use, thing):
        try:
            use(thing)
        except ValueError as error:
            if "closed" not in str(error):
                errors.append(error)
        except Exception as error:
            errors.append(error)

    request = anthronet.Request("female")
    jobs = [(lambda: model.generate(request), lambda body: body.to_bytes("glb", lod=3)),
            (lambda: woman.mesh(lod=1), lambda mesh: mesh[0].read("positions")),
            (lambda: anthronet.builtin_clip("walk", woman), lambda clip: clip.bake("model"))]
    threads = [threading.Thread(target=work, args=job) for job in jobs]
    for thread in threads:
        thread.start()
    stop.wait(3)
    stop.set()
    for thread in threads:
        thread.join()
    assert not errors, errors[:2]


def test_threads(woman, model):
    """8 threads that generate, mesh, sample and skin have the results of one"""
    walk = anthronet.builtin_clip("walk", woman)
    skinner, mesh = woman.mesh(lod=1).skinner(), woman.mesh(lod=1)
    shared = anthronet.Request("male")

    def one(i):
        request = shared.copy()
        request.seed, request["height"] = i % 4, 1.75 + i % 4 * 0.02
        body = model.generate(request)
        pose = walk.sample(i % 4 / 5, relative="model")
        return body.to_bytes("obj", lod=3), skinner.skin(pose)[0].tobytes(), mesh[0].read("normals").tobytes()

    expected, results = [one(i) for i in range(4)], {}

    def work(i):
        for _ in range(6):
            results.setdefault(i, []).append(one(i))

    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 8 and all(len(r) == 6 and set(r) == {expected[i % 4]} for i, r in results.items())


def test_one_request_of_many_threads(woman, man):
    """one request and one mesh changed and read by 8 threads stay whole"""
    request, mesh, errors = anthronet.Request(height=1.7), woman.mesh(lod=3), []
    surfaces = {body.mesh(lod=3)[0].positions.tobytes() for body in (woman, man)}

    def work(i):
        try:
            for round in range(60):
                if i % 2:
                    request[anthronet.MEASURES[i]] = 0.5 + round / 1000
                    mesh.update(man if round % 2 else woman)
                    mesh.add_blend_shape(f"{i} {round}", man)
                else:
                    assert request["height"] == 1.7 and anthronet.Request.from_json(request.to_json())["height"] == 1.7
                    assert mesh[0].positions.tobytes() in surfaces
                    mesh.blend_shapes
        except Exception as error:
            errors.append(error)

    threads = [threading.Thread(target=work, args=(i,)) for i in (0, 1, 2, 5, 4, 7, 6, 9)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors, errors[:2]
    assert all(anthronet.MEASURES[i] in request for i in (1, 5, 7, 9)), "no change was lost"


def progress_of_others(call):
    """How far another thread of Python comes during each of five calls."""
    # So long an interval that nobody is interrupted: one goes on only while the other waits or is in the library.
    interval, counted, seen = sys.getswitchinterval(), [0], []

    def work():
        for _ in range(5):
            before = counted[0]
            call()
            seen.append(counted[0] - before)

    sys.setswitchinterval(1000)
    try:
        thread = threading.Thread(target=work)
        thread.start()
        while thread.is_alive():
            counted[0] += 1
            time.sleep(0.0005)  # Hands the lock over.
    finally:
        sys.setswitchinterval(interval)
    return seen


def test_lock_is_released(model):
    """other threads of Python go on during a call"""
    request = anthronet.Request("female", height=1.71)
    seen = progress_of_others(lambda: model.generate(request))
    assert len(seen) == 5 and sum(seen) > 5, seen
    # The same call with the interpreter's lock held, so that this could have failed.
    held, body = ctypes.PyDLL(_library.lib._name).anthronet_generate, ctypes.c_void_p()
    held.argtypes = _library.lib.anthronet_generate.argtypes
    seen = progress_of_others(lambda: held(model._open, request._handle, ctypes.byref(body), None))
    assert seen == [0] * 5, seen


def test_log(model):
    """messages come to the callback, what it raises goes no further, and it must not call back"""
    heard = []
    anthronet.set_log_callback(lambda level, message: heard.append((level, message)))
    try:
        warnings = anthronet.generate("female", nearest=True, **CONFLICT).report["warnings"]
        assert warnings and [message for _, message in heard] == warnings and {level for level, _ in heard} == {1}
        hooked, hook = [], sys.unraisablehook
        sys.unraisablehook = lambda unraisable: hooked.append(unraisable.exc_value)
        try:
            anthronet.set_log_callback(lambda level, message: anthronet.generate())
            anthronet.generate("female", nearest=True, **CONFLICT)
            assert hooked and isinstance(hooked[0], RuntimeError) and "callback" in str(hooked[0]), hooked
        finally:
            sys.unraisablehook = hook
    finally:
        anthronet.set_log_callback(None)
    count = len(heard)
    anthronet.generate("female", nearest=True, **CONFLICT)
    assert len(heard) == count, "nobody hears any more"
    raises(TypeError, lambda: anthronet.set_log_callback(3), "callback", "int")
    other = []
    anthronet.set_log_callback(lambda level, message: other.append(threading.get_ident()))
    with model.start([anthronet.Request("female", nearest=True, **CONFLICT)]) as job:
        job.wait()
    anthronet.set_log_callback(None)
    assert other and other[0] != threading.get_ident(), "a job speaks from its own thread"


def script(text, **environment):
    return subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})


def test_exit():
    """a process ends well with jobs running, views alive and a log callback set"""
    done = script("import anthronet\n"
                  "anthronet.set_log_callback(lambda level, message: None)\n"
                  "job = anthronet.default_model().start([anthronet.Request(seed=i, nearest=True) for i in range(500)])\n"
                  "view = anthronet.generate().mesh()[0].positions\n"
                  "print(job.progress.state)\n")
    assert (done.returncode, done.stdout.strip(), done.stderr) == (0, "running", ""), done


def in_a_fork(work):
    """What a forked child makes of `work`: its exit status, 0 where `work` returns True; killed after a minute."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            status = 0 if work() else 2
        finally:
            os._exit(status)
    for _ in range(1200):
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.05)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return "hangs"


def test_fork(woman, model):
    """a forked child, as of multiprocessing, has what its parent has and waits for none of its threads"""
    if not hasattr(os, "fork"):
        pytest.skip("there is no fork here")
    warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns of forks beside threads: this test is about them.
    skinner, walk = woman.mesh().skinner(), anthronet.builtin_clip("walk", woman)
    pose = walk.sample(0.4, relative="model")
    expected = skinner.skin(pose)[0]  # On the threads of the pool, which the child has not.
    body = model.generate(anthronet.Request("male")).to_bytes("obj", lod=3)

    def work():
        made = model.generate(anthronet.Request("male")).to_bytes("obj", lod=3)
        return np.array_equal(skinner.skin(pose)[0], expected) and made == body

    assert in_a_fork(work) == 0
    job = model.start([anthronet.Request(seed=i) for i in range(100)])

    def of_the_parent():
        try:
            job.take(99)
        except anthronet.CancelledError:
            state = job.wait(60).state
            job.close()
            gc.collect()
            with model.start([anthronet.Request("male")]) as own:
                return state == "cancelled" and [b.to_bytes("obj", lod=3) for b in own.results()] == [body]

    assert in_a_fork(of_the_parent) == 0
    job.cancel()
    job.close()
    assert np.array_equal(skinner.skin(pose)[0], expected), "the parent goes on"


def test_default_model_file():
    """ANTHRONET_MODEL names the default model, and a wrong one is an error that names it"""
    use = "import anthronet; print(anthronet.generate('male').sex)"
    file = ROOT / "model" / "anthronet.safetensors"
    assert script(use, ANTHRONET_MODEL=str(file)).stdout == "male\n"
    done = script(use, ANTHRONET_MODEL="no such model")
    assert done.returncode == 1 and "no such model" in done.stderr.splitlines()[-1], done.stderr


SOURCES = {
    "another": ("int other(void) { return 0; }", "is not libanthronet"),
    "of another version": ("int anthronet_abi_version(void) { return 99; }", "version 99"),
    "without functions": (f"int anthronet_abi_version(void) {{ return {anthronet.abi_version()}; }}", "lacks anthronet_"),
}


@pytest.fixture(params=["not there", "not there, without an extension", "text", *SOURCES])
def wrong_library(request, tmp_path):
    """The path of a library that is none of ours, and what is said of it."""
    path = tmp_path / "wrong.so"
    if request.param == "not there":
        return path, "no such file"
    if request.param == "not there, without an extension":
        return Path(np.__file__).parent.parent / "no", "no such file"
    if request.param == "text":
        path.write_text("no library", encoding="utf-8")
        return path, "does not load"
    if shutil.which("cc") is None:
        pytest.skip("no C compiler `cc`")
    code, said = SOURCES[request.param]
    source = tmp_path / "wrong.c"
    source.write_text(code, encoding="utf-8")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", path, source], check=True)
    return path, said


def test_library_that_is_none(wrong_library):
    """a library that is wrong is an ImportError that says what to do"""
    path, said = wrong_library
    done = script("import anthronet", ANTHRONET_LIBRARY=str(path))
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: anthronet: ") and said in last and "ANTHRONET_LIBRARY" in last, last
    assert str(path) in last, last


def test_raw_pointers():
    """handles that are NULL are errors, not crashes"""
    null = ctypes.c_void_p()
    raises(anthronet.ArgumentError, lambda: _library.json_of(_library.lib.anthronet_body_report, null), "NULL")
