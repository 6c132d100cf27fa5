# SPDX-License-Identifier: GPL-3.0-or-later
"""Access to the library. It is loaded when it is first needed, not when Blender starts."""


class LibraryError(Exception):
    """The library cannot be loaded. The message says what is missing and which paths were searched."""


def anthronet():
    """The Python package ``anthronet`` from the extension's wheel."""
    try:
        import anthronet as package
    except (ImportError, OSError) as error:
        raise LibraryError(f"the AnthroNet library cannot be loaded: {error}") from error
    return package


def model():
    """The default model, which the package loads once."""
    return anthronet().default_model()


def failures():
    """The exceptions whose messages are for the user. Blender's own operators raise RuntimeError."""
    own = (LibraryError, ValueError, OSError, RuntimeError)
    try:
        return (*own, anthronet().Error)
    except LibraryError:
        return own
