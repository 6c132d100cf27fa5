namespace Anthronet
{
    /// <summary>This package.</summary>
    public static class AnthroPackage
    {
        /// <summary>Its version: that of the library, the command and all other packages.</summary>
        public const string Version = "0.1.0";
    }
}
