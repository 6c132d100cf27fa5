using System.Linq;
using Anthronet.Editor;
using NUnit.Framework;

namespace Anthronet.Tests
{
    /// Labels and reports in the inspector.
    [TestFixture]
    public static class RequestGuiTests
    {
        [Test(Description = "labels are the measures in words with their unit, the same for both sides")]
        public static void Labels()
        {
            Expect.Equal("Waist circumference (m)", AnthroRequestGui.Label(0), "label");
            int central = AnthroMeasures.Central, side = AnthroMeasures.PerSide;
            Expect.Equal(AnthroMeasures.Count, central + 2 * side, "central, left, right");
            for (var i = central; i < central + side; i++)
            {
                Expect.Equal(AnthroRequestGui.Label(i), AnthroRequestGui.Label(i + side), "sides of " + i);
            }
            Expect.Equal(central + side, Enumerable.Range(0, AnthroMeasures.Count).Select(AnthroRequestGui.Label).Distinct().Count(), "labels");
        }

        [Test(Description = "reports have the percentile, and the residual of a requested measure or the interval of another")]
        public static void Reports()
        {
            var report = new AnthroMeasureReport { obtained = 1.7, residual = -0.0004, low90 = 1.6, high90 = 1.8, percentile = 61.7 };
            Expect.Equal("residual -0.4 mm, percentile 62", AnthroRequestGui.ReportText(report, true), "given");
            Expect.Equal("1.700 m (90 %: 1.600 to 1.800), percentile 62", AnthroRequestGui.ReportText(report, false), "open");
        }
    }
}
