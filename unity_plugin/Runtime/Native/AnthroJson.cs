using System;
using System.Globalization;

namespace Anthronet.Native
{
    /// <summary>
    /// Reads top-level values of JSON objects that the library wrote: words, numbers, lists of numbers. Not a general
    /// JSON parser; Unity has none for such objects.
    /// </summary>
    internal struct AnthroJson
    {
        readonly string json;

        public AnthroJson(string json)
        {
            this.json = json;
        }

        /// <summary>A word or number without quotes; null if the key is missing or its value is null.</summary>
        public string Word(string key)
        {
            var start = Start(key);
            if (start < 0)
            {
                return null;
            }
            var end = json.IndexOfAny(new[] { ',', '}' }, start);
            var word = json.Substring(start, end - start).Trim().Trim('"');
            return word == "null" ? null : word;
        }

        /// <summary>A list of numbers; empty if the key is missing or its value is null.</summary>
        public double[] Numbers(string key)
        {
            var start = Start(key);
            if (start < 0 || json[start] != '[')
            {
                return new double[0];
            }
            var words = json.Substring(start + 1, json.IndexOf(']', start) - start - 1)
                .Split(new[] { ',' }, StringSplitOptions.RemoveEmptyEntries);
            return Array.ConvertAll(words, word => double.Parse(word, CultureInfo.InvariantCulture));
        }

        int Start(string key)
        {
            var quoted = "\"" + key + "\":";
            var at = json.IndexOf(quoted, StringComparison.Ordinal);
            if (at < 0)
            {
                return -1;
            }
            at += quoted.Length;
            while (json[at] == ' ' || json[at] == '\n')
            {
                at++;
            }
            return at;
        }
    }
}
