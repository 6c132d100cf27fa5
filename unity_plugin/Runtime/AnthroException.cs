using System;

namespace Anthronet
{
    /// <summary>What kind of error it is: the library's codes.</summary>
    public enum AnthroError
    {
        /// <summary>A pointer is missing: a defect of this package.</summary>
        Pointer = 101,
        /// <summary>A number of entries is not what it must be.</summary>
        Size = 102,
        /// <summary>A number is none of the values of its enumeration.</summary>
        Enum = 103,
        /// <summary>An index is beyond the last.</summary>
        Index = 104,
        /// <summary>A text is not UTF-8.</summary>
        Text = 105,
        /// <summary>A field of a request is unknown, not finite, or out of range.</summary>
        Request = 201,
        /// <summary>The measures of a request cannot belong to one person.</summary>
        Infeasible = 202,
        /// <summary>A model file is damaged or of another version.</summary>
        Model = 301,
        /// <summary>A file is not what it should be.</summary>
        File = 401,
        /// <summary>The operating system refused to read or write.</summary>
        Io = 402,
        /// <summary>Data contradicts itself.</summary>
        Invalid = 501,
        /// <summary>The job is still running.</summary>
        Busy = 601,
        /// <summary>The job was cancelled before this was made.</summary>
        Cancelled = 602,
        /// <summary>What was asked for was taken before.</summary>
        Taken = 603,
        /// <summary>An error of a younger kind.</summary>
        Other = 900,
        /// <summary>A defect of the library, caught. Please report it.</summary>
        Panic = 901,
    }

    /// <summary>What the library refused, with a sentence that says why.</summary>
    [Serializable]
    public sealed class AnthroException : Exception
    {
        /// <summary>An error with its code and message.</summary>
        public AnthroException(AnthroError code, string message) : base(message)
        {
            Code = code;
        }

        /// <summary>Its kind.</summary>
        public AnthroError Code { get; private set; }
    }
}
