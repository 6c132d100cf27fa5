using System;
using System.Collections.Generic;

namespace Anthronet
{
    /// <summary>Many requests in one text, one per line, such as in a TextAsset.</summary>
    public static class AnthroPopulation
    {
        /// <summary>Reads one request per line, as `AnthroRequest.FromJson` does; skips empty lines.</summary>
        /// <exception cref="AnthroException">A line is not valid; the message has its number, from 1.</exception>
        public static AnthroRequest[] Read(string lines)
        {
            Native.Library.NotNull(lines, "lines");
            var requests = new List<AnthroRequest>();
            var number = 0;
            foreach (var line in lines.Split('\n'))
            {
                number++;
                var json = line.Trim();
                if (json.Length == 0)
                {
                    continue;
                }
                try
                {
                    requests.Add(AnthroRequest.FromJson(json));
                }
                catch (AnthroException error)
                {
                    throw new AnthroException(error.Code, "line " + number + ": " + error.Message);
                }
            }
            return requests.ToArray();
        }
    }
}
