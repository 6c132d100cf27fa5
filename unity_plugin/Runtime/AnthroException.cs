using System;

namespace Anthronet
{
    /// <summary>Error codes of the native library.</summary>
    public enum AnthroError
    {
        /// <summary>A required pointer is null: a bug in this package.</summary>
        Pointer = 101,
        /// <summary>A count or an array length is wrong.</summary>
        Size = 102,
        /// <summary>A value is not defined in its enumeration.</summary>
        Enum = 103,
        /// <summary>An index is out of range.</summary>
        Index = 104,
        /// <summary>A text is not valid UTF-8.</summary>
        Text = 105,
        /// <summary>A field of a request is unknown, not finite, or out of range.</summary>
        Request = 201,
        /// <summary>No person can have the measures of the request.</summary>
        Infeasible = 202,
        /// <summary>A model file is damaged or has another version.</summary>
        Model = 301,
        /// <summary>A file is not valid.</summary>
        File = 401,
        /// <summary>The operating system could not read or write.</summary>
        Io = 402,
        /// <summary>Data is inconsistent.</summary>
        Invalid = 501,
        /// <summary>The job is still running.</summary>
        Busy = 601,
        /// <summary>The job was cancelled before this result was made.</summary>
        Cancelled = 602,
        /// <summary>The result was already taken.</summary>
        Taken = 603,
        /// <summary>An error of a kind that this version of the package does not know.</summary>
        Other = 900,
        /// <summary>A bug in the library. Please report it.</summary>
        Panic = 901,
    }

    /// <summary>An error of the native library; the message says what is wrong.</summary>
    [Serializable]
    public sealed class AnthroException : Exception
    {
        /// <summary>An error with a code and a message.</summary>
        public AnthroException(AnthroError code, string message) : base(message)
        {
            Code = code;
        }

        /// <summary>The error code.</summary>
        public AnthroError Code { get; private set; }
    }
}
