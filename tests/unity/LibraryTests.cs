using System;
using System.Diagnostics;
using System.IO;
using NUnit.Framework;

namespace Anthronet.Tests
{
    /// The native library itself.
    [TestFixture]
    public static class LibraryTests
    {
        [Test(Description = "without the library a program gets an error with the expected file and how to get it")]
        public static void Missing()
        {
            var start = new ProcessStartInfo("mono", "\"" + typeof(LibraryTests).Assembly.Location + "\" --missing");
            start.UseShellExecute = false;
            start.RedirectStandardOutput = true;
            start.RedirectStandardError = true;
            start.WorkingDirectory = Path.GetTempPath();
            start.EnvironmentVariables.Remove("LD_LIBRARY_PATH");
            using (var program = Process.Start(start))
            {
                var said = program.StandardOutput.ReadToEnd();
                var complained = program.StandardError.ReadToEnd();
                program.WaitForExit();
                Expect.Equal(0, program.ExitCode, "it ends with, after \"" + said + complained + "\",");
                Expect.That(said.Contains("Packages/com.anthronet.unity/Runtime/Plugins/Linux/x86_64/libanthronet.so")
                    && said.Contains("cargo xtask package unity") && said.Contains("import settings"), said);
            }
        }
    }
}
