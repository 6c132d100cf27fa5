using NUnit.Framework;

namespace Anthronet.Tests
{
    /// Population files.
    [TestFixture]
    public static class PopulationTests
    {
        [Test(Description = "a population has one request per line, and errors have the line number")]
        public static void Lines()
        {
            var requests = AnthroPopulation.Read(
                "{\"sex\": \"female\", \"seed\": 3}\r\n\n  {\"measures\": {\"height\": 1.7}, \"fill\": \"sample\"}\n");
            Expect.Equal(2, requests.Length, "requests");
            Expect.Equal(AnthroSex.Female, requests[0].Sex, "sex");
            Expect.Equal(3ul, requests[0].Seed, "seed");
            Expect.That(requests[1].IsGiven(3) && requests[1].Fill == AnthroFill.Sample, "the second");
            Expect.Equal(0, AnthroPopulation.Read("").Length, "an empty file");
            Expect.Code(AnthroError.Request, "line 3", () => AnthroPopulation.Read("{}\n\n{\"sex\": \"both\"}\n{}"), "a bad line");
            Expect.Code(AnthroError.Request, "shoe", () => AnthroPopulation.Read("{\"measures\": {\"shoe\": 1}}"), "a bad name");
            Expect.Throws<System.ArgumentNullException>(() => AnthroPopulation.Read(null), "no text");
        }
    }
}
