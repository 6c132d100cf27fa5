namespace Anthronet
{
    /// <summary>This package.</summary>
    public static class AnthroPackage
    {
        /// <summary>The version, the same as that of the native library and all other AnthroNet packages.</summary>
        public const string Version = "0.1.0";
    }
}
