using System;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Advances spawns every frame within a time budget; in edit mode, at every editor update. Spawns end with play mode.
    /// </summary>
    [AddComponentMenu("")]
    public sealed class AnthroRunner : MonoBehaviour
    {
        const double DefaultBudget = 4.0;

        static readonly List<AnthroSpawn> spawns = new List<AnthroSpawn>();
        static AnthroRunner runner;

        /// <summary>Time budget per frame of all spawns together, milliseconds.</summary>
        public static double Budget = DefaultBudget;

        /// <summary>Number of unfinished spawns.</summary>
        public static int Count
        {
            get { return spawns.Count; }
        }

        /// <summary>Advances a spawn every frame until it is done, then disposes it.</summary>
        /// <returns>The spawn.</returns>
        public static AnthroSpawn Run(AnthroSpawn spawn)
        {
            Native.Library.NotNull(spawn, "spawn");
            spawns.Add(spawn);
            if (Application.isPlaying)
            {
                if (runner == null)
                {
                    var home = new GameObject("AnthroNet Runner");
                    // Not `DontSave`: such an object would survive the end of play mode.
                    home.hideFlags = HideFlags.HideInHierarchy;
                    DontDestroyOnLoad(home);
                    runner = home.AddComponent<AnthroRunner>();
                }
                return spawn;
            }
#if UNITY_EDITOR
            UnityEditor.EditorApplication.update -= Tick;
            UnityEditor.EditorApplication.update += Tick;
#endif
            return spawn;
        }

        void Update()
        {
            Tick();
        }

        /// <summary>Advances all spawns. A spawn that throws is logged and abandoned; the others continue.</summary>
        static void Tick()
        {
            for (var i = spawns.Count - 1; i >= 0; i--)
            {
                var spawn = spawns[i];
                var done = true;
                try
                {
                    done = spawn.Advance(Budget / spawns.Count);
                }
                catch (Exception error)
                {
                    Debug.LogException(error);
                }
                if (done)
                {
                    spawns.Remove(spawn);
                    spawn.Dispose();
                }
            }
#if UNITY_EDITOR
            if (spawns.Count == 0)
            {
                UnityEditor.EditorApplication.update -= Tick;
            }
#endif
        }

        void OnDestroy()
        {
            ReleaseAll();
        }

        /// <summary>Disposes all spawns.</summary>
        internal static void ReleaseAll()
        {
            foreach (var spawn in spawns)
            {
                spawn.Dispose();
            }
            spawns.Clear();
        }

        // With domain reload disabled, static fields survive from the previous play session.
        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        static void Restart()
        {
            ReleaseAll();
            runner = null;
            Budget = DefaultBudget;
        }
    }
}
