using System.Collections.Generic;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>Settings of characters that the factory makes.</summary>
    public sealed class AnthroSettings
    {
        /// <summary>Finest level of detail, 0 to 3.</summary>
        public int finestLod = 1;
        /// <summary>Coarsest level of detail, 0 to 3.</summary>
        public int coarsestLod = 3;
        /// <summary>Skin tone on the Monk scale, 1 to 10; 0 for the default.</summary>
        public int skinTone;
        /// <summary>Leaves out eyes, teeth, tongue and eyelashes.</summary>
        public bool bodyOnly;
        /// <summary>Builds a humanoid avatar.</summary>
        public bool humanoid = true;
        /// <summary>Parent transform; null for the root of the scene.</summary>
        public Transform parent;
        /// <summary>The model to generate with; null for `AnthroModel.Default`.</summary>
        public AnthroModel model;
        /// <summary>Pool to take characters from, which keep the levels of detail that they have; null for
        /// none.</summary>
        public AnthroPool pool;

        internal AnthroSettings Copy()
        {
            return (AnthroSettings)MemberwiseClone();
        }
    }

    /// <summary>Makes characters from scripts.</summary>
    public static class AnthroFactory
    {
        /// <summary>Makes a character synchronously, on the main thread.</summary>
        /// <exception cref="AnthroException">The request is refused; the scene is unchanged.</exception>
        public static AnthroCharacter Create(AnthroRequest request, AnthroSettings settings = null)
        {
            settings = settings ?? new AnthroSettings();
            var body = (settings.model ?? AnthroModel.Default).Generate(request);
            var character = CreateInactive(request, settings);
            try
            {
                character.SetBody(body);
            }
            catch
            {
                character.Release();
                AnthroObjects.DestroySafely(character.gameObject);
                throw;
            }
            character.gameObject.SetActive(true);
            return character;
        }

        /// <summary>
        /// Makes characters asynchronously: bodies and mesh data on worker threads, then GameObjects on the main thread
        /// in time slices. `AnthroSpawn.Advance` has to be called every frame; `AnthroRunner.Run` does that.
        /// </summary>
        public static AnthroSpawn CreateAsync(IList<AnthroRequest> requests, AnthroSettings settings = null)
        {
            var copies = new AnthroRequest[Library.NotNull(requests, "requests").Count];
            for (var i = 0; i < copies.Length; i++)
            {
                copies[i] = Library.NotNull(requests[i], "requests").Copy();
            }
            return new AnthroSpawn(copies, settings == null ? new AnthroSettings() : settings.Copy());
        }

        /// <summary>An inactive character, invisible until it is complete: from the pool, or a new one.</summary>
        internal static AnthroCharacter CreateInactive(AnthroRequest request, AnthroSettings settings)
        {
            var character = settings.pool == null ? null : settings.pool.Get();
            if (character == null)
            {
                var made = new GameObject("AnthroNet Character");
                made.SetActive(false);
                character = made.AddComponent<AnthroCharacter>();
                character.GenerateOnAwake = false;
                character.FinestLod = settings.finestLod;
                character.CoarsestLod = settings.coarsestLod;
            }
            character.transform.SetParent(settings.parent, false);
            character.Request = request.Copy();
            character.SkinTone = settings.skinTone;
            character.BodyOnly = settings.bodyOnly;
            character.Humanoid = settings.humanoid;
            return character;
        }
    }
}
