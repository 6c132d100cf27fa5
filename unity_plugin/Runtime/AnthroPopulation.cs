using System;
using System.Collections.Generic;

namespace Anthronet
{
    /// <summary>Many requests in one text, a line each, such as a TextAsset holds.</summary>
    public static class AnthroPopulation
    {
        /// <summary>Reads requests: one as `AnthroRequest.FromJson` takes it in every line; empty lines are none.</summary>
        /// <exception cref="AnthroException">A line is no request; the message names it, counted from 1.</exception>
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
