# SPDX-License-Identifier: GPL-3.0-or-later
"""The door to the library. Nothing is loaded before something needs it."""


class LibraryError(Exception):
    """The library cannot be loaded; the message says what is missing and where it was looked for."""


def anthronet():
    """The package ``anthronet`` that the extension carries."""
    try:
        import anthronet as package
    except (ImportError, OSError) as error:
        raise LibraryError(f"the AnthroNet library cannot be loaded: {error}") from error
    return package


def model():
    """The model, opened once."""
    return anthronet().default_model()


def failures():
    """What calls of this extension may raise for a reason that the user should read. RuntimeError is what Blender's own
    operators raise."""
    own = (LibraryError, ValueError, OSError, RuntimeError)
    try:
        return (*own, anthronet().Error)
    except LibraryError:
        return own
