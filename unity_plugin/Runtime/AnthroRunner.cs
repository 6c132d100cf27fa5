using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>Advances spawns each frame within a budget of time.</summary>
    [AddComponentMenu("")]
    public sealed class AnthroRunner : MonoBehaviour
    {
        static AnthroRunner runner;

        readonly List<AnthroSpawn> spawns = new List<AnthroSpawn>();

        /// <summary>Milliseconds of each frame for all spawns together.</summary>
        public static double Budget = 4.0;

        /// <summary>Advances a spawn each frame until it is done, then frees it.</summary>
        /// <returns>The spawn.</returns>
        public static AnthroSpawn Run(AnthroSpawn spawn)
        {
            if (runner == null)
            {
                var home = new GameObject("AnthroNet Runner");
                home.hideFlags = HideFlags.HideAndDontSave;
                if (Application.isPlaying)
                {
                    DontDestroyOnLoad(home);
                }
                runner = home.AddComponent<AnthroRunner>();
            }
            runner.spawns.Add(spawn);
            return spawn;
        }

        void Update()
        {
            for (var i = spawns.Count - 1; i >= 0; i--)
            {
                var spawn = spawns[i];
                if (spawn.Advance(Budget / spawns.Count))
                {
                    spawns.RemoveAt(i);
                    spawn.Dispose();
                }
            }
        }

        void OnDestroy()
        {
            foreach (var spawn in spawns)
            {
                spawn.Dispose();
            }
            spawns.Clear();
        }

        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        static void Restart()
        {
            runner = null;
            Budget = 4.0;
        }
    }
}
